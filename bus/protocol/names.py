"""Numbers of the protocol by name: device types, identifiers, opcodes, results. They are schmidt.dbc's."""

from enum import IntEnum, IntFlag
from typing import Any, Final, Self

COMMAND_BASE: Final = 0x080
"""Identifier of a device's COMMAND is this plus its device type; likewise below."""
REPLY_BASE: Final = 0x100
MEASUREMENT_BASE: Final = 0x200
"""MOTION, POSITION, TACH and FOCUS: the frames of the 64-byte HID report."""
SUMMARY_BASE: Final = 0x300
"""TARGET and SUMMARY, 250 ms."""
HEARTBEAT_BASE: Final = 0x700
SUMMARY_KIND: Final = 0xF3
"""Byte 1 of TARGET and SUMMARY."""
HEARTBEAT_KIND: Final = 0xF7
"""Byte 1 of HEARTBEAT."""
FRAME_BYTES: Final = 8
"""Length of every documented frame."""


class _Open(IntEnum):
    """Numbers with names, and further ones that boards declare (`bus/protocol/nodes/`).

    Nobody keeps a list of the further ones, so that two networks in one process may have different ones.
    """

    @property
    def declared(self) -> Any:
        """What a further one was declared with; None: it is written out here."""
        return vars(self).get("_declared")

    @classmethod
    def further(cls, name: str, number: int, declared: object) -> Self:
        """A further one; the way the standard library makes the unnamed members of a Flag."""
        made = int.__new__(cls, number)
        made._name_, made._value_ = name, number
        vars(made)["_declared"] = declared
        return made

    @classmethod
    def _missing_(cls, value: object) -> Self | None:
        return cls.further(*value) if isinstance(value, tuple) else None

    def __reduce_ex__(self, _protocol: object) -> tuple[Any, ...]:
        if self.declared is None:
            return type(self), (self.value,)
        return type(self), ((self.name, self.value, self.declared),)


class Device(_Open):
    """Byte 0 of every frame: who it comes from, or in a COMMAND whom it is for. declared: its `Kind`."""

    AXIS_RA = 0x11
    AXIS_DEC = 0x12
    POSITION_RA = 0x21
    POSITION_DEC = 0x22
    MOTOR_RA_A = 0x31
    MOTOR_RA_B = 0x32
    MOTOR_DEC_A = 0x33
    MOTOR_DEC_B = 0x34
    FOCUS = 0x41
    DISPLAY = 0x51
    GATEWAY = 0x61


class Opcode(_Open):
    """Byte 1 of a COMMAND, repeated in byte 1 of its REPLY. declared: format and names of its arguments."""

    PING = 0x01
    GET_PARAMETER = 0x02
    SET_PARAMETER = 0x03
    POWER = 0x10
    STOP = 0x11
    SET_RATE = 0x12
    SET_CLASS = 0x13
    MOVE_TO = 0x14
    TRACK_RATE = 0x15
    OPEN_LOOP = 0x16
    NUDGE = 0x17
    FOCUS_STEP = 0x20
    FOCUS_MOVE_TO = 0x21
    FOCUS_HOLD = 0x22
    FOCUS_FREE = 0x23
    FOCUS_REFERENCE = 0x24
    BRIGHTNESS = 0x30


class Result(IntEnum):
    """Byte 2 of a REPLY."""

    OK = 0
    UNKNOWN_OPCODE = 1
    WRONG_LENGTH = 2
    OUT_OF_RANGE = 3
    NOT_ALLOWED = 4
    WRONG_DEVICE_TYPE = 5


class Health(IntFlag):
    """Value of the REPLY to PING; 0 is healthy. ASSUMPTION: the paper says "health check" and no more."""

    SENSOR = 0x01
    STALE = 0x02
    BUS = 0x04
    OVERRUN = 0x08
    DROPPED = 0x10
    """Something found no room (a buffer, the inbox) in the last ten seconds; the count stays."""
    LIMIT = 0x20
    FAULT = 0x40
    FOREIGN = 0x80
    """Frames with a peer's identifier that are no frames of it, in the last ten seconds."""
    RANGE = 0x100
    """A value did not fit its field and was cut to the largest that does, in the last ten seconds."""


class State(IntEnum):
    """State byte of a HEARTBEAT."""

    BOOT = 0
    READY = 1
    ACTIVE = 2
    FAULT = 3


class AxisMode(IntEnum):
    """Mode nibble of MOTION."""

    OFF = 0
    STOP = 1
    RATE = 2
    CLASS = 3
    MOVE = 4
    TRACK = 5
    OPEN_LOOP = 6


class SpeedClass(IntEnum):
    """Speed classes of the axes (paper: slew, set, guide, fine; track for RA)."""

    NONE = 0
    SLEW = 1
    SET = 2
    GUIDE = 3
    FINE = 4
    TRACK = 5


class AxisParameter(IntEnum):
    """Parameters of an axis board."""

    COUNTER_SPLIT_PERCENT = 1
    KP_Q12 = 2
    KI_Q12 = 3
    LIMIT_LOW_STEPS = 4
    LIMIT_HIGH_STEPS = 5
    ACCELERATION = 6
    RATE_SLEW_Q16 = 7
    RATE_SET_Q16 = 8
    RATE_GUIDE_Q16 = 9
    RATE_FINE_Q16 = 10
    RATE_TRACK_Q16 = 11
    DUTY_FRACTION = 12
    """0: whole PWM steps, the paper's firmware. 1: the fraction is spread over PWM periods."""
    COMPENSATION = 13
    """0: off. 1: the table below and the friction model are added to the effort."""
    FRICTION_LEVEL_Q8 = 14
    """Effort that sliding friction takes, PWM steps in Q8."""
    FRICTION_TRAVEL_COUNTS = 15
    """Travel over which friction turns after a reversal, counts of the roller encoder."""
    HARMONIC_FIRST = 16
    """Line k of the table: 16 + 3k is its order, cycles per turn of the axis, Q16.

    17 + 3k and 18 + 3k are the effort of its cosine and sine over the absolute encoder's angle, PWM steps in
    Q8."""

    COUNTER_BIAS_Q8 = 40
    """Duty that both motors always get, PWM steps in Q8."""
    RATE_LOCK = 41
    """1: RATE and CLASS hold the sum of the set point as well."""
    POSITION_BLEND = 42
    """Time constant, 2^n ticks of 5 ms, below which the position loop trusts the incremental encoder; 0: the
    absolute encoder alone."""
    OBSERVER = 43
    """1: a state observer in place of the PI near the tracking rate; it stays 0 with unsound coefficients."""
    OBSERVER_FIRST = 44
    """Its coefficients up to 68: `boards/axis/observer.py`."""


HARMONICS: Final = 8
"""Lines of the compensation table."""
OBSERVER_CELLS: Final = 25
"""Coefficients of the observer: four sections of six, and one more."""
