"""What the display shows, from raw measurements. Four lines of twenty characters, ASSUMPTION."""

from bus.protocol import Focus, FocusFlag, PositionFlag, Summary
from bus.protocol.scales import STEPS_PER_TURN
from bus.units import ARCSEC_PER_TURN

COLUMNS = 20
_HALF_STEP_NM = 6250
"""6.25 um per half step (paper, section 3.2)."""
_BAD = PositionFlag.ALARM | PositionFlag.CRC_ERROR


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
