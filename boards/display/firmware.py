"""Firmware of the display: shows the last SUMMARY of each axis and the last FOCUS, four times a second."""

from boards.core import PeriodicBoard, Place
from boards.core.commands import Command
from boards.display.interrupts import FCY_HZ, TABLE
from boards.display.text import focus_line, position_line
from boards.silicon.can import FULL_MASK
from bus.protocol import (
    COMMAND_BASE,
    MEASUREMENT_BASE,
    SUMMARY_BASE,
    Opcode,
    unpack_focus,
    unpack_summary,
)

TICK_NS = 250_000_000
_HEARTBEAT_TICKS = 4


class DisplayBoard(PeriodicBoard):
    """position_types: device types of the RA and Dec encoder boards; focus_type: of the focus board."""

    __slots__ = ("_dec", "_focus", "_ra", "_shown", "brightness")

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
