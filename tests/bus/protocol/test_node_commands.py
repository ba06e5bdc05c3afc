"""Opcodes of a declared board: arguments laid out as cantools packs them, bounds, what cannot be."""

from pathlib import Path

import pytest
from cantools.database import load_string

from bus.protocol import layout_of
from bus.protocol.nodes import DOME, Kind, KindError
from bus.protocol.nodes.messages import Argument, arguments_of

HEAD = 'VERSION ""\nBU_: GATEWAY NODE\n'
COMMAND = HEAD + 'BO_ 128 COMMAND: 8 GATEWAY\n SG_ Opcode M : 8|8@1+ (1,0) [0|255] "" NODE\n'


def text(signals: str, opcodes: str) -> str:
    return f"{COMMAND}{signals}VAL_ 128 Opcode {opcodes} ;\n"


def argument(name: str, number: int, place: str, scale: str = "(1,0)", limits: str = "[0|1]") -> str:
    return f' SG_ {name} m{number} : {place} {scale} {limits} "" NODE\n'


def kind(folder: Path, signals: str, opcodes: str) -> Kind:
    """A kind whose DBC has these arguments; each has a folder of its own, as files are read once."""
    file = folder / "own.dbc"
    file.write_text(text(signals, opcodes))
    return Kind(f"K{abs(hash(str(folder)))}", {}, file)


PLACES = [
    ("16|8@1+", 200), ("16|8@1-", -100), ("16|16@1+", 60_000), ("16|16@1-", -30_000),
    ("16|32@1+", 4_000_000_000), ("16|32@1-", -2_000_000_000), ("56|8@1+", 7), ("48|16@1-", -2),
    ("32|32@1+", 9), ("24|8@1+", 3),
]  # fmt: skip


@pytest.mark.parametrize(("place", "value"), PLACES)
def test_an_argument_lies_where_its_dbc_says(tmp_path: Path, place: str, value: int) -> None:
    signals = argument("Do_It", 0x50, place)
    (opcode,) = arguments_of(kind(tmp_path, signals, '80 "DO"'))
    message = load_string(text(signals, '80 "DO"'), "dbc").messages[0]
    layout, names = layout_of(opcode)
    packed = bytes([0, 0x50]) + layout.pack(value)
    assert packed == message.encode({"Opcode": 0x50, "Do_It": value}, strict=False)
    assert (len(packed), names) == (8, ("it",))


def test_several_arguments_go_in_the_order_of_their_places(tmp_path: Path) -> None:
    signals = argument("Do_Last", 0x50, "40|16@1-") + argument("Do_First", 0x50, "16|8@1+")
    signals += argument("Other_Thing", 0x51, "16|8@1+") + argument("Do_Spare_One", 0x50, "24|8@1+")
    found = arguments_of(kind(tmp_path, signals, '80 "DO" 81 "OTHER"'))
    layout, names = layout_of(next(iter(found)))
    assert names == ("first", "last")
    assert layout.pack(5, -2) == bytes([5, 0, 0, 0xFE, 0xFF, 0])
    assert {int(opcode): len(arguments) for opcode, arguments in found.items()} == {0x50: 2, 0x51: 1}
    assert [opcode.name for opcode in found] == ["DO", "OTHER"]


def test_bounds_are_those_of_the_wire(tmp_path: Path) -> None:
    """By hand: value = 0.5 raw - 40, so -40..10 are 0..100."""
    signals = argument("Do_It", 0x50, "16|8@1+", "(0.5,-40)", "[-40|10]")
    ((arguments,),) = (arguments_of(kind(tmp_path, signals, '80 "DO"')).values(),)
    assert arguments == (Argument("it", 0, 100),)


def test_an_opcode_without_arguments_is_six_empty_bytes(tmp_path: Path) -> None:
    found = arguments_of(kind(tmp_path, "", '64 "FIRST" 125 "LAST"'))
    assert [int(opcode) for opcode in found] == [0x40, 0x7D]
    assert layout_of(max(found))[0].pack() == bytes(6)


def test_a_kind_without_commands_has_none(tmp_path: Path) -> None:
    file = tmp_path / "own.dbc"
    file.write_text(
        'VERSION ""\nBU_: GATEWAY NODE\nBO_ 512 X: 8 NODE\n SG_ A : 8|8@1+ (1,0) [0|1] "" GATEWAY\n'
    )
    assert arguments_of(Kind("NOCOMMANDS", {}, file)) == {}


@pytest.mark.parametrize("number", [0, 3, 0x3F, 0x7E, 0x7F, 255])
def test_other_opcodes_are_not_a_declared_boards(tmp_path: Path, number: int) -> None:
    with pytest.raises(KindError, match=f"opcode {number:#04x}: a declared board's own are 0x40..0x7d"):
        arguments_of(kind(tmp_path, "", f'{number} "DO"'))


@pytest.mark.parametrize("place", ["16|7@1+", "16|24@1+", "17|8@1+", "20|16@1+", "0|8@1+", "57|7@1+"])
def test_an_argument_is_whole_bytes_behind_the_opcode(tmp_path: Path, place: str) -> None:
    with pytest.raises(KindError, match=r"Do_It: an argument is 1, 2 or 4 bytes within bytes 2\.\.7"):
        arguments_of(kind(tmp_path, argument("Do_It", 0x50, place), '80 "DO"'))


def test_an_argument_beyond_the_eighth_byte_is_refused(tmp_path: Path) -> None:
    given = kind(tmp_path, argument("Do_It", 0x50, "64|8@1+"), '80 "DO"')
    given.dbc.write_text(given.dbc.read_text().replace("COMMAND: 8", "COMMAND: 16"))
    with pytest.raises(KindError, match=r"Do_It: an argument is 1, 2 or 4 bytes within bytes 2\.\.7"):
        arguments_of(given)


def test_an_opcode_may_be_two_kinds_own_with_other_arguments(tmp_path: Path) -> None:
    for name, sign in (("a", "+"), ("b", "-")):
        (tmp_path / name).mkdir()
        (opcode,) = arguments_of(kind(tmp_path / name, argument("Do_It", 0x50, f"16|8@1{sign}"), '80 "DO"'))
        assert layout_of(opcode)[0].format == ("<0xB5x" if sign == "+" else "<0xb5x")


def test_the_domes() -> None:
    goto, shutter, stop = arguments_of(DOME).values()
    assert (goto, shutter, stop) == ((Argument("azimuth", 0, 35999),), (Argument("open", 0, 1),), ())
