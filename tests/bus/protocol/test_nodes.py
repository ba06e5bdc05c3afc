"""Declared boards: codecs against cantools, the file for other tools, and declarations that cannot be."""

import pickle
from pathlib import Path
from typing import Any

import pytest
from cantools.database import load_file, load_string
from hypothesis import given, settings
from hypothesis import strategies as st

from bus.protocol import CommandError, Device, Opcode, pack_command
from bus.protocol.nodes import (
    DEVICES,
    DOME,
    KINDS,
    FrameCodec,
    Kind,
    KindError,
    arguments_of,
    check_kind,
    documented,
    kind_of,
    messages_of,
    own_messages,
)
from bus.protocol.page import DBC_PATH

MEASURED = [m for kind in KINDS for m in messages_of(kind) if 0x200 <= m.frame_id < 0x400]


@pytest.mark.parametrize("message", MEASURED, ids=lambda message: message.name)
@settings(max_examples=50)
@given(data=st.data())
def test_B8_packing_is_what_cantools_makes_of_the_dbc(message: Any, data: Any) -> None:
    codec = FrameCodec(message)
    raw = {
        signal.name: data.draw(
            st.integers(round(signal.minimum / signal.scale), round(signal.maximum / signal.scale))
        )
        for signal in message.signals
    }
    values = {signal.name: raw[signal.name] * signal.scale for signal in message.signals}
    packed = codec.pack(values)
    assert packed == message.encode(values, scaling=True, strict=False)
    again = codec.unpack(packed)
    decoded = message.decode(packed, decode_choices=False)
    assert again == pytest.approx({name: decoded[name] for name in again})
    assert set(decoded) - set(again) == {"Device"}


def test_what_does_not_fit_is_cut_and_told() -> None:
    codec = FrameCodec(next(m for m in MEASURED if m.name == "WEATHER_MAST_WEATHER"))
    told: list[int] = []
    packed = codec.pack({"Wind": 1e6, "Temperature": -1e6}, lambda: told.append(1))
    assert len(told) == 2
    assert codec.unpack(packed)["Wind"] == pytest.approx(75.0)
    assert codec.unpack(packed)["Temperature"] == pytest.approx(-60.0)


def test_final_dbc_says_what_the_declarations_say() -> None:
    def facts(database: Any) -> dict[int, Any]:
        return {
            message.frame_id: (
                message.name, message.length, message.cycle_time, message.comment, message.senders,
                sorted(
                    (s.name, s.start, s.length, s.is_signed, s.scale, s.offset, s.minimum, s.maximum, s.unit,
                     s.comment, s.choices, s.multiplexer_ids)
                    for s in message.signals
                ),
            )
            for message in database.messages
        }  # fmt: skip

    assert facts(load_file(DBC_PATH, strict=True)) == facts(documented(DEVICES))


def test_frames_of_a_declared_board_are_moved_to_its_type() -> None:
    """docs/reference/protocol.md: bases 0x080, 0x100, 0x200, 0x700; the dome is 0x71."""
    frames = {message.name: message for message in messages_of(DOME)}
    assert [(frame.frame_id, frame.length, frame.cycle_time) for frame in frames.values()] == [
        (0xF1, 8, None), (0x171, 8, None), (0x271, 8, 100), (0x771, 8, 1000),
    ]  # fmt: skip
    named = {1: "PING", 2: "GET_PARAMETER", 3: "SET_PARAMETER"}
    own = {0x40: "DOME_GOTO", 0x41: "DOME_SHUTTER", 0x42: "DOME_STOP"}
    choices = {
        "Device": {0x71: "DOME"},
        "Opcode": named | own,
        "GetParameter_Number": {1: "TOLERANCE_CENTIDEGREES", 2: "CLOSE_IN_BAD_WEATHER"},
        "SetParameter_Number": {1: "TOLERANCE_CENTIDEGREES", 2: "CLOSE_IN_BAD_WEATHER"},
    }
    for name, frame in frames.items():
        to_board = name == "DOME_COMMAND"
        assert frame.senders == ["GATEWAY" if to_board else "DOME"]
        for signal in frame.signals[1:]:
            assert signal.receivers == ["DOME" if to_board else "GATEWAY"], signal.name
        device = frame.signals[0]
        assert (device.start, device.length, device.raw_initial) == (0, 8, 0x71)
        assert device.minimum == device.maximum == 0x71
        for signal in frame.signals:
            told = signal.choices and {number: str(word) for number, word in signal.choices.items()}
            assert told == choices.get(signal.name) or signal.name in ("Result", "State"), signal.name
    assert [each.name for each in frames["DOME_COMMAND"].signals if each.multiplexer_ids == [0x40]] == [
        "Goto_Azimuth"
    ]


def test_a_summary_of_a_declared_board_has_its_kind(tmp_path: Path) -> None:
    file = tmp_path / "x.dbc"
    file.write_text(
        'VERSION ""\nBU_: GATEWAY NODE\n'
        'BO_ 512 X: 8 NODE\n SG_ A : 8|8@1+ (1,0) [0|1] "" GATEWAY\n'
        'BO_ 768 Y: 8 NODE\n SG_ B : 16|8@1+ (1,0) [0|1] "" GATEWAY\n'
        'BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\nBA_DEF_DEF_ "GenMsgCycleTime" 0;\n'
        'BA_ "GenMsgCycleTime" BO_ 512 250;\nBA_ "GenMsgCycleTime" BO_ 768 100;\n'
    )
    kind = Kind("X", {"X": 0x7A}, file)
    assert [message.name for message in own_messages(kind)] == ["Y", "X"], "the shorter period first"
    summary = next(message for message in messages_of(kind) if message.frame_id == 0x37A)
    assert FrameCodec(summary).pack({"B": 1}) == bytes([0x7A, 0xF3, 1, 0, 0, 0, 0, 0])
    byte = summary.get_signal_by_name("Kind")
    assert (byte.start, byte.length, byte.raw_initial) == (8, 8, 0xF3)


def test_declared_devices_and_opcodes_know_what_they_are_and_are_not_counted() -> None:
    assert (len(Device), len(DEVICES)) == (11, 18)
    dome, goto = DOME.device("DOME"), next(iter(arguments_of(DOME)))
    assert (dome, goto, dome.name, goto.name) == (0x71, 0x40, "DOME", "DOME_GOTO")
    assert kind_of(dome) is DOME and kind_of(Device.DISPLAY) is None
    assert arguments_of(DOME)[goto][0].high == 35999
    assert pack_command(dome, goto, 12345) == bytes([0x71, 0x40, 0x39, 0x30, 0, 0, 0, 0])
    with pytest.raises(ValueError, match="113"):
        Device(0x71)
    with pytest.raises(CommandError, match="opcode 0x40 is not in the protocol"):
        pack_command(dome, 0x40, 12345)


@pytest.mark.parametrize("each", [Device.FOCUS, DOME.device("DOME"), *arguments_of(DOME)])
def test_written_and_declared_ones_go_through_a_pipe(each: Device | Opcode) -> None:
    again = pickle.loads(pickle.dumps(each))
    assert (again, again.name, again.declared, type(again)) == (each, each.name, each.declared, type(each))


@pytest.mark.parametrize(
    ("name", "nodes", "text"),
    [
        ("lower", {"lower": 0x7A}, "capitals"),
        ("OTHER", {"DOME_2": 0x7A}, "are called OTHER"),
        ("OTHER", {"OTHER": 0x80}, "not within"),
        ("OTHER", {"OTHER": 0}, "not within"),
        ("FOCUS", {"FOCUS": 0x7A}, "is taken"),
        ("OTHER_X", {"OTHER_X": 0x7A}, "without an underscore"),
        ("OTHER", {"OTHER": 0x71}, "is taken"),
        ("OTHER", {"OTHER": 0x11}, "is taken"),
        ("DOME", {"DOME": 0x7A}, "declared twice"),
    ],
)
def test_a_declaration_that_cannot_be_is_one_line(name: str, nodes: dict[str, int], text: str) -> None:
    with pytest.raises(KindError, match=text) as error:
        check_kind(Kind(name, nodes, Path("none.dbc")), KINDS)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("number", [0x01, 0x7F])
def test_a_declaration_may_have_any_free_type(number: int) -> None:
    check_kind(Kind("OTHER", {"OTHER": number}, Path("none.dbc")), KINDS)


GOOD = 'BO_ 512 X: 8 NODE\n SG_ A : 8|8@1+ (1,0) [0|1] "" GATEWAY\n'


@pytest.mark.parametrize(
    ("text", "complaint"),
    [
        ("BO_ nonsense", "no DBC"),
        (GOOD, "GenMsgCycleTime"),
        (GOOD.replace("512", "513"), "513"),
        (GOOD.replace("X: 8", "X: 4"), "4 bytes"),
        (GOOD + ' SG_ B : 12|8@1+ (1,0) [0|1] "" GATEWAY\n', "no DBC: .*overlapping"),
    ],
)
def test_a_dbc_that_cannot_be_is_one_line(tmp_path: Path, text: str, complaint: str) -> None:
    file = tmp_path / "x.dbc"
    file.write_text(f'VERSION ""\nBU_: GATEWAY NODE\n{text}')
    with pytest.raises(KindError, match=complaint) as error:
        own_messages(Kind("X", {"X": 0x7A}, file))
    assert "\n" not in str(error.value)


def test_a_dbc_that_is_not_there_is_one_line(tmp_path: Path) -> None:
    with pytest.raises(KindError, match="no such file"):
        own_messages(Kind("X", {"X": 0x7A}, tmp_path / "none.dbc"))


def test_an_offset_missing_values_and_fields_without_limits() -> None:
    """By hand: T = 0.5 raw - 40, unsigned; S signed; neither has bounds of its own."""
    database = load_string(
        'VERSION ""\nBU_: A B\nBO_ 512 X: 8 A\n SG_ T : 8|8@1+ (0.5,-40) [0|0] "" B\n'
        ' SG_ S : 16|8@1- (1,0) [0|0] "" B\nBA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
        'BA_DEF_DEF_ "GenMsgCycleTime" 0;\nBA_ "GenMsgCycleTime" BO_ 512 250;\n',
        "dbc",
    )
    codec = FrameCodec(database.messages[0])
    assert codec.period_ns == 250_000_000
    assert codec.pack({"T": 20.0, "S": -3}) == bytes([0, 120, 0xFD, 0, 0, 0, 0, 0])
    assert codec.pack({}) == bytes([0, 80, 0, 0, 0, 0, 0, 0])
    assert codec.unpack(bytes([0, 120, 0xFD, 0, 0, 0, 0, 0])) == {"T": 20.0, "S": -3}
    assert codec.unpack(bytes([0, 80, 100, 0, 0, 0, 0, 0])) == {"T": 0.0, "S": 100}
    told: list[int] = []
    assert codec.pack({"T": 1e3, "S": 200}, lambda: told.append(1)) == bytes([0, 255, 127, 0, 0, 0, 0, 0])
    assert codec.pack({"T": -41, "S": -200}, lambda: told.append(1)) == bytes([0, 0, 128, 0, 0, 0, 0, 0])
    assert len(told) == 4


def test_limits_are_in_the_fields_unit() -> None:
    """By hand: T = 0.5 raw - 40 from -30 to 10 is raw 20 to 100."""
    codec = FrameCodec(
        load_string(HAND.format(' SG_ T : 16|8@1+ (0.5,-40) [-30|10] "" B\n'), "dbc").messages[0]
    )
    sent = [codec.pack({"T": value})[2] for value in (-31.0, -30.0, 10.0, 10.5)]
    assert sent == [20, 20, 100, 100]


HAND = (
    'VERSION ""\nBU_: A B\nBO_ 785 X: 8 A\n{}BA_DEF_ BO_ "GenMsgCycleTime" INT 0 65535;\n'
    'BA_DEF_DEF_ "GenMsgCycleTime" 0;\nBA_ "GenMsgCycleTime" BO_ 785 250;\n'
)


def test_constants_stand_where_the_dbc_has_them() -> None:
    """Device type 0x11 in byte 0, the kind 0xF3 in byte 1; a device field that may vary is a value."""
    fields = ' SG_ Device : 0|8@1+ (1,0) [17|17] "" B\n SG_ Kind : 8|8@1+ (1,0) [243|243] "" B\n'
    codec = FrameCodec(
        load_string(HAND.format(fields + ' SG_ A : 16|8@1+ (1,0) [0|9] "" B\n'), "dbc").messages[0]
    )
    assert codec.pack({"A": 3}) == bytes([0x11, 0xF3, 3, 0, 0, 0, 0, 0])
    assert codec.unpack(bytes([0x11, 0xF3, 3, 0, 0, 0, 0, 0])) == {"A": 3}
    varied = FrameCodec(
        load_string(HAND.format(' SG_ Device : 0|8@1+ (1,0) [17|18] "" B\n'), "dbc").messages[0]
    )
    assert varied.pack({"Device": 18}) == bytes([18, 0, 0, 0, 0, 0, 0, 0])


def test_big_endian_is_refused() -> None:
    message = load_string(HAND.format(' SG_ A : 23|8@0+ (1,0) [0|9] "" B\n'), "dbc").messages[0]
    with pytest.raises(ValueError, match="little endian"):
        FrameCodec(message)
