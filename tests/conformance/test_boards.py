"""Boards by type and identifier, and each way of writing them wrongly."""

import pytest

from bus.conformance import Board, BoardError, board_of, parse
from bus.conformance.boards import family_of
from bus.protocol import Device
from bus.protocol.nodes import DEVICES

TYPES = "auxiliary, axis, display, dome, focus, gateway, motor, position, power, weather"


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("axis:0x13", Board("AXIS:0x13", "AXIS", 0x13, Device.AXIS_RA)),
        ("Axis:1", Board("AXIS:0x01", "AXIS", 1, Device.AXIS_RA)),
        ("axis:0x7f", Board("AXIS:0x7f", "AXIS", 127, Device.AXIS_RA)),
        ("axis:0x12", Board("AXIS_DEC", "AXIS", 0x12, Device.AXIS_DEC)),
        ("AXIS:17", Board("AXIS_RA", "AXIS", 0x11, Device.AXIS_RA)),
        ("position:0x11", Board("POSITION:0x11", "POSITION", 0x11, Device.POSITION_RA)),
        ("motor:0b110100", Board("MOTOR_DEC_B", "MOTOR", 0x34, Device.MOTOR_DEC_B)),
        ("motor:0x40", Board("MOTOR:0x40", "MOTOR", 0x40, Device.MOTOR_RA_A)),
    ],
)
def test_a_board_is_of_a_type_and_has_an_identifier(text: str, found: Board) -> None:
    assert parse(text) == found


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("axis", "expected TYPE:ID, such as axis:0x11"),
        ("", "expected TYPE:ID, such as axis:0x11"),
        ("axle:0x11", f'no type "axle"; expected {TYPES}'),
        ("axis:", '"" is not a number such as 0x11'),
        ("axis:eleven", '"eleven" is not a number such as 0x11'),
        ("axis:0x11:2", '"0x11:2" is not a number such as 0x11'),
        ("axis:0", "a device type is 1 to 0x7f, not 0"),
        ("axis:-1", "a device type is 1 to 0x7f, not -1"),
        ("axis:0x80", "a device type is 1 to 0x7f, not 0x80"),
    ],
)
def test_a_mistake_is_one_line(text: str, reason: str) -> None:
    with pytest.raises(BoardError) as error:
        parse(text)
    assert str(error.value) == f'--board "{text}": {reason}'


def test_only_known_types_are_named() -> None:
    with pytest.raises(BoardError, match=r"expected axis, display$"):
        parse("dome:1", [Device.AXIS_DEC, Device.DISPLAY, Device.AXIS_RA])
    assert parse("axis:1", [Device.AXIS_DEC, Device.AXIS_RA]).model == Device.AXIS_DEC


@pytest.mark.parametrize("device", DEVICES)
def test_every_board_that_comes_along_can_be_written(device: Device) -> None:
    assert parse(f"{family_of(device)}:{device:#x}") == board_of(device)
    assert board_of(device) == Board(device.name, device.name.split("_")[0], int(device), device)
