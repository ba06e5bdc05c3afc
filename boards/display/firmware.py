"""Firmware of the display: shows the last SUMMARY of each axis and the last FOCUS, four times a second.

ASSUMPTIONS: a PIC18 at 10 MIPS with an MCP2515, four lines of twenty characters. The paper names no part.
"""

from boards.core import PeriodicBoard, Place, Source
from boards.core.commands import Command
from boards.silicon.can import FULL_MASK
from bus.protocol import (
    COMMAND_BASE,
    MEASUREMENT_BASE,
    SUMMARY_BASE,
    Focus,
    FocusFlag,
    Opcode,
    PositionFlag,
    Summary,
    unpack_focus,
    unpack_summary,
)
from bus.protocol.scales import STEPS_PER_TURN
from bus.units import ARCSEC_PER_TURN

COLUMNS = 20
_HALF_STEP_NM = 6250
"""6.25 um per half step (paper, section 3.2)."""
_BAD = PositionFlag.ALARM | PositionFlag.CRC_ERROR
FCY_HZ = 10_000_000

TABLE = (
    Source(
        "refresh", priority=2, latency_cycles=12, cost_cycles=5000
    ),  # 500 us: format and shift out the text
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)


TICK_NS = 250_000_000
_HEARTBEAT_TICKS = 4


class DisplayBoard(PeriodicBoard):
    """position_types: device types of the RA and Dec encoder boards; focus_type: of the focus board."""

    def __init__(self, place: Place, position_types: tuple[int, int], focus_type: int) -> None:
        super().__init__(place, FCY_HZ, TABLE, TICK_NS)
        self.brightness = 100
        self.reset()
        ra, dec = (SUMMARY_BASE + position for position in position_types)
        focus = MEASUREMENT_BASE + focus_type
        self.mail |= {ra: self._take_ra, dec: self._take_dec, focus: self._take_focus}
        self.can.accept((FULL_MASK, [COMMAND_BASE + self.device_type]), (FULL_MASK, [ra, dec, focus]))
        self.commands = self.common_commands() | {
            Opcode.BRIGHTNESS: Command(Opcode.BRIGHTNESS, self._set_brightness, [(0, 100)])
        }

    def reset(self) -> None:
        """After power-up nothing is known."""
        self._ra: bytes | None = None
        self._dec: bytes | None = None
        self._focus: bytes | None = None
        self._shown: tuple[bytes | None, ...] = (None, None, None)

    @property
    def lines(self) -> tuple[str, str, str]:
        """What the display shows: RA, Dec, focus; as of the last refresh."""
        ra, dec, focus = self._shown
        return (
            position_line("RA ", unpack_summary(ra) if ra else None),
            position_line("DEC", unpack_summary(dec) if dec else None),
            focus_line(unpack_focus(focus) if focus else None),
        )

    def routine(self, t_ns: int) -> None:
        """Timer interrupt, every 250 ms."""
        end = self.enter(t_ns)
        if not end:
            return
        self._shown = (self._ra, self._dec, self._focus)
        if self.ticks % _HEARTBEAT_TICKS == 1:
            self.heartbeat(end)

    def _take_ra(self, _t_ns: int, data: bytes) -> None:
        self._ra = data

    def _take_dec(self, _t_ns: int, data: bytes) -> None:
        self._dec = data

    def _take_focus(self, _t_ns: int, data: bytes) -> None:
        self._focus = data

    def _set_brightness(self, _t_ns: int, percent: int) -> None:
        self.brightness = percent


def angle(steps: int) -> str:
    """Encoder angle as degrees, minutes, seconds and tenths, in the integers a PIC would use."""
    tenths = steps * ARCSEC_PER_TURN * 10 // STEPS_PER_TURN
    seconds, tenth = divmod(tenths, 10)
    minutes, second = divmod(seconds, 60)
    degree, minute = divmod(minutes, 60)
    return f"{degree:3d} {minute:02d} {second:02d}.{tenth}"


def position_line(label: str, summary: Summary | None) -> str:
    """Line of one axis; dashes while nothing has come, an error mark for a bad reading."""
    if summary is None:
        return f"{label} --- -- --.-".ljust(COLUMNS)
    mark = "!" if summary.flags & _BAD else "L" if summary.flags else " "
    return f"{label} {angle(summary.position)} {mark}".ljust(COLUMNS)


def focus_line(focus: Focus | None) -> str:
    """Line of the focus: micrometres, and whether it moves, is referenced, holds or is free."""
    if focus is None:
        return "FOC ------".ljust(COLUMNS)
    flags = focus.flags
    state = "MOVE" if flags & FocusFlag.MOVING else "FREE" if flags & FocusFlag.FREE else "HOLD"
    nanometres = focus.position * _HALF_STEP_NM
    sign = "-" if nanometres < 0 else "+"
    micrometres, rest = divmod(abs(nanometres), 1000)
    mark = " " if flags & FocusFlag.REFERENCED else "?"
    return f"FOC {sign}{micrometres:4d}.{rest // 10:02d}{mark} {state}".ljust(COLUMNS)
