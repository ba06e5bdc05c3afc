"""EnDat: mode commands, memory areas, additional information, alarms, times as tables (hardware.md 3.1)."""

from enum import Enum, IntEnum, IntFlag, auto
from typing import NamedTuple

from boards.silicon.endat import POSITION_BITS


class Reply(Enum):
    """What the encoder answers with."""

    POSITION = auto()
    POSITION_22 = auto()
    PARAMETER = auto()
    TEST = auto()


class Mode(NamedTuple):
    """A mode command. argument: 24 bits follow it at once; supplement: they follow the answer (2.2)."""

    name: str
    reply: Reply
    argument: bool = False
    supplement: bool = False


SEND_POSITION, SEND_POSITION_INFO = 0b000111, 0b111000
SELECT_MEMORY, RECEIVE_PARAMETER, SEND_PARAMETER = 0b001110, 0b011100, 0b100011
RECEIVE_RESET, SEND_TEST_VALUES, RECEIVE_TEST, RECEIVE_COMMUNICATION = 0b101010, 0b010101, 0b110001, 0b010010
POSITION_SELECT, POSITION_RECEIVE, POSITION_SEND = 0b001001, 0b011011, 0b100100
POSITION_ERROR_RESET, POSITION_TEST = 0b101101, 0b110110

_P, _Q, _R, _T = Reply.POSITION, Reply.POSITION_22, Reply.PARAMETER, Reply.TEST
MODES: dict[int, Mode] = {
    SEND_POSITION: Mode("send position", _P),
    SEND_POSITION_INFO: Mode("send position and additional information", _Q),
    SELECT_MEMORY: Mode("select memory area", _R, argument=True),
    RECEIVE_PARAMETER: Mode("receive parameter", _R, argument=True),
    SEND_PARAMETER: Mode("send parameter", _R, argument=True),
    RECEIVE_RESET: Mode("receive reset", _R, argument=True),
    SEND_TEST_VALUES: Mode("send test values", _T),
    RECEIVE_TEST: Mode("receive test command", _R, argument=True),
    RECEIVE_COMMUNICATION: Mode("receive communication command", _R, argument=True),
    POSITION_SELECT: Mode("position, select memory area", _Q, supplement=True),
    POSITION_RECEIVE: Mode("position, receive parameter", _Q, supplement=True),
    POSITION_SEND: Mode("position, send parameter", _Q, supplement=True),
    POSITION_ERROR_RESET: Mode("position, receive error reset", _Q, supplement=True),
    POSITION_TEST: Mode("position, receive test command", _Q, supplement=True),
}


class Area(IntEnum):
    """MRS codes of memory areas."""

    MANUFACTURER_0 = 0xA1
    MANUFACTURER_1 = 0xA3
    MANUFACTURER_2 = 0xA5
    OPERATING = 0xA7
    OEM_0 = 0xA9
    OEM_1 = 0xAB
    OEM_2 = 0xAD
    STATUS = 0xB9
    MANUFACTURER_22 = 0xBD
    OEM_22 = 0xBF


WRITABLE_AREAS = frozenset({Area.OPERATING, Area.OEM_0, Area.OEM_1, Area.OEM_2, Area.OEM_22})
"""ASSUMPTION: the manufacturer's pages are closed to everybody else."""
ALARM_WORD, WARNING_WORD, RECOVERY_WORD = 0, 1, 3
"""Words of Area.STATUS. Writing 0 to one of the first two clears it, nothing else does anything."""


class Alarm(IntFlag):
    """Word 0 of Area.STATUS; any of them sets F1."""

    LIGHT = 1
    AMPLITUDE = 2
    POSITION = 4
    OVER_VOLTAGE = 8
    UNDER_VOLTAGE = 16
    OVER_CURRENT = 32
    BATTERY = 64


class Info(IntEnum):
    """Content of additional information 1 (40h..4Fh) and 2 (50h..5Fh): the MRS code that selects it."""

    NOP_1 = 0x40
    POSITION2_LOW = 0x42
    POSITION2_MIDDLE = 0x43
    MEMORY_LSB = 0x45
    MEMORY_MSB = 0x46
    MRS_ACKNOWLEDGE = 0x47
    TEST_ACKNOWLEDGE = 0x48
    TEST_LOW = 0x49
    TEST_MIDDLE = 0x4A
    TEST_HIGH = 0x4B
    TEMPERATURE_1 = 0x4C
    STOP_1 = 0x4F
    NOP_2 = 0x50
    ERROR_SOURCE = 0x59
    STOP_2 = 0x5F


WRN, RM, BUSY = 0x80, 0x40, 0x20
"""Status byte of additional information; its low five bits say the content."""

DUMMY_CLOCKS, MODE_BITS, TURN_CLOCKS, ARGUMENT_BITS = 2, 6, 2, 24
ACCESS_NS = 12_000_000
"""t_ac: memory access takes at most this; taken as long as it may be."""
RESET_NS = 50_000_000
"""No answer for this long after a reset or power-up."""
HIGH_RESETS_NS = 10_000
"""Clock HIGH for longer takes the encoder back to idle in the middle of a transfer."""
LOW_RESETS_NS = 50_000_000
"""t_LO: longer LOW does too."""
SHORT_RECOVERY_NS = 2_500
"""t_m within 1.25..3.75 us, when word 3 of Area.STATUS selects it (2.2, f_C > 1 MHz)."""


def words() -> dict[tuple[int, int], int]:
    """Memory as delivered: (area, word) -> 16 bits. Words not named are 0, as identity and serial number.

    A rotary single-turn encoder.
    """
    return {
        (Area.MANUFACTURER_0, 13): POSITION_BITS,
        (Area.MANUFACTURER_0, 14): 0x8000,
        (Area.MANUFACTURER_1, 5): (1 << POSITION_BITS) >> 16,
        (Area.MANUFACTURER_2, 5): 0x0001,
    }
