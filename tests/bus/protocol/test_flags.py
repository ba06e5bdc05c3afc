"""Flags lie where the DBC has them, and what does not fit its field is told of; mutants of the codecs showed
that nothing looked."""

from enum import IntFlag

import pytest

from bus import protocol as p
from bus.protocol.database import database
from bus.protocol.names import HARMONICS, OBSERVER_CELLS

FLAGS: list[tuple[str, type[IntFlag], int]] = [
    ("AXIS_RA_MOTION", p.MotionFlag, 12),
    ("POSITION_RA_POSITION", p.PositionFlag, 8),
    ("FOCUS_FOCUS", p.FocusFlag, 8),
]
"""Frame, flags, bit of the first (the flags' field; docs/reference/protocol.md)."""


@pytest.mark.parametrize(("frame", "kind", "first"), FLAGS, ids=[each[0] for each in FLAGS])
def test_every_flag_is_at_its_bit_of_the_dbc(frame: str, kind: type[IntFlag], first: int) -> None:
    starts = {s.name.lower(): s.start for s in database().get_message_by_name(frame).signals}
    for name, flag in kind.__members__.items():  # going through the class leaves out what is no single bit
        assert 1 << (starts[name.lower().replace("_", "")] - first) == flag


def test_what_does_not_fit_is_cut_and_told_of_once() -> None:
    told: list[str] = []
    data = p.pack_focus(0x41, 0, 40_000, -40_000, 2000, lambda: told.append("focus"))
    assert (p.unpack_focus(data).position, p.unpack_focus(data).encoder) == (32_767, -32_768)
    assert told == ["focus"]
    assert p.pack_focus(0x41, 0, 1, 2, 3, lambda: told.append("again")) and told == ["focus"]


def test_parameters_of_an_axis_have_the_numbers_of_the_dbc() -> None:
    message = database().get_message_by_name("AXIS_RA_COMMAND")
    choices = message.get_signal_by_name("GetParameter_Number").choices
    assert choices is not None
    numbers = {str(name): number for number, name in choices.items()}
    first = {"HARMONIC_FIRST": "HARMONIC_0_ORDER_Q16", "OBSERVER_FIRST": "OBSERVER_0"}
    for name, parameter in p.AxisParameter.__members__.items():  # of two with one number the second, too
        assert numbers[first.get(name, name)] == parameter
    assert sum(name.endswith("_ORDER_Q16") for name in numbers) == HARMONICS
    assert sum(name.startswith("OBSERVER_") for name in numbers) == OBSERVER_CELLS


def test_health_has_a_bit_for_each_word_from_the_lowest_on() -> None:
    assert [flag.value for flag in p.Health] == [1 << bit for bit in range(9)]


@pytest.mark.parametrize("opcode", [0x12, p.Opcode.SET_RATE])
def test_arguments_that_do_not_fit_name_the_opcode(opcode: int) -> None:
    with pytest.raises(p.CommandError, match=r"SET_RATE takes .*; \(1, 2, 3, 4\) does not fit"):
        p.pack_command(0x11, opcode, 1, 2, 3, 4)
