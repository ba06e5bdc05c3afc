"""The hand-written codecs against cantools on schmidt.dbc, on values drawn from the signals' own ranges."""

from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from bus import protocol as p
from bus.protocol.database import database

MESSAGES = [message for message in database().messages if not message.name.endswith("_COMMAND")]
COMMANDS = [message for message in database().messages if message.name.endswith("_COMMAND")]


def flags(values: dict[str, int], *names: str) -> int:
    return sum(values[name] << bit for bit, name in enumerate(names))


POSITION_FLAGS = ("Alarm", "Warning", "CrcError", "LimitLow", "LimitHigh")
PACK: dict[str, Any] = {
    "REPLY": lambda v: p.pack_reply(v["Device"], v["Opcode"], v["Result"], v["Parameter"], v["Value"]),
    "MOTION": lambda v: p.pack_motion(
        v["Device"],
        v["Mode"] | flags(v, "Moving", "SoftLimit", "Fault", "Powered") << 4,
        v["Velocity"],
        v["Effort"],
        (v["AdcA"], v["AdcB"]),
    ),
    "POSITION": lambda v: p.pack_position(
        v["Device"], flags(v, *POSITION_FLAGS), v["Position"], v["Age"], v["Sequence"]
    ),
    "SUMMARY": lambda v: p.pack_summary(v["Device"], flags(v, *POSITION_FLAGS), v["Position"]),
    "TACH": lambda v: p.pack_tach(v["Device"], v["Flags"], v["Count"], v["Delta"]),
    "FOCUS": lambda v: p.pack_focus(
        v["Device"],
        flags(v, "Moving", "Referenced", "Hold", "Free", "IndexSeen"),
        v["Position"],
        v["Encoder"],
        v["Lvdt"],
    ),
    "TARGET": lambda v: p.pack_target(v["Device"], v["SpeedClass"], v["Settled"], v["Distance"]),
    "HEARTBEAT": lambda v: p.pack_heartbeat(v["Device"], v["State"], v["Uptime"], v["Overruns"], v["Tec"]),
}
UNPACK: dict[str, Any] = {
    "REPLY": p.unpack_reply,
    "MOTION": p.unpack_motion,
    "POSITION": p.unpack_position,
    "SUMMARY": p.unpack_summary,
    "TACH": p.unpack_tach,
    "FOCUS": p.unpack_focus,
    "TARGET": p.unpack_target,
    "HEARTBEAT": p.unpack_heartbeat,
}


def values_of(draw: Any, message: Any, names: list[str] | None = None) -> dict[str, int]:
    signals = [signal for signal in message.signals if names is None or signal.name in names]
    values = {signal.name: draw(st.integers(signal.minimum, signal.maximum)) for signal in signals}
    return {**values, **({"Spare": 0} if "Spare" in values else {})}


@pytest.mark.parametrize("message", MESSAGES, ids=lambda message: message.name)
@settings(max_examples=25)  # the same layout comes back for every device of a family
@given(data=st.data())
def test_L1_packing_is_what_the_dbc_says(message: Any, data: Any) -> None:
    values = values_of(data.draw, message)
    suffix = message.name.rpartition("_")[2]
    packed = PACK[suffix](values)
    assert packed == message.encode(values)
    assert message.decode(packed, decode_choices=False) == values
    fields = UNPACK[suffix](packed)
    assert fields.device == values["Device"]
    again = {name: value for name, value in fields._asdict().items() if name not in ("device", "flags")}
    by_lower = {name.lower(): value for name, value in values.items()}
    renamed = {"adc_a": "adca", "adc_b": "adcb", "counts": "count", "speed_class": "speedclass"}
    assert all(by_lower[renamed.get(name, name)] == value for name, value in again.items())
    if hasattr(fields, "flags") and suffix != "TACH":
        one_bit = [signal.name for signal in message.signals if signal.length == 1]
        assert fields.flags == flags(values, *one_bit)


@pytest.mark.parametrize("message", COMMANDS, ids=lambda message: message.name)
@settings(max_examples=40)
@given(data=st.data())
def test_L1_commands_are_what_the_dbc_says(message: Any, data: Any) -> None:
    device = p.Device[message.name.removesuffix("_COMMAND")]
    opcode = data.draw(st.sampled_from(p.opcodes(device)))
    multiplexed = next(part for part in message.signal_tree if isinstance(part, dict))["Opcode"]
    names = [name for name in multiplexed[opcode] if not name.endswith("_Spare")]
    values = values_of(data.draw, message, names)
    packed = p.pack_command(device, opcode, *(values[name] for name in names))
    spare = {name: 0 for name in multiplexed[opcode] if name.endswith("_Spare")}
    assert packed == message.encode({"Device": int(device), "Opcode": int(opcode), **values, **spare})
    assert p.unpack_command(packed) == (device, opcode, tuple(values.values()))


def test_L1_the_dbc_has_the_opcodes_of_each_device() -> None:
    for message in COMMANDS:
        device = p.Device[message.name.removesuffix("_COMMAND")]
        multiplexed = next(part for part in message.signal_tree if isinstance(part, dict))["Opcode"]
        assert set(multiplexed) == set(p.opcodes(device))
        choices = message.get_signal_by_name("Opcode").choices
        assert {number: str(name) for number, name in choices.items()} == {
            int(opcode): opcode.name for opcode in p.opcodes(device)
        }


ENUMS = [
    ("AXIS_RA_MOTION", "Mode", p.AxisMode),
    ("AXIS_RA_TARGET", "SpeedClass", p.SpeedClass),
    ("AXIS_RA_REPLY", "Result", p.Result),
    ("FOCUS_HEARTBEAT", "State", p.State),
]


@pytest.mark.parametrize(("message", "signal", "enum"), ENUMS)
def test_L1_enums_are_the_value_tables(message: str, signal: str, enum: Any) -> None:
    choices = database().get_message_by_name(message).get_signal_by_name(signal).choices or {}
    assert {number: str(name) for number, name in choices.items()} == {int(e): e.name for e in enum}


def test_L1_every_frame_has_eight_bytes_and_starts_with_its_device_type() -> None:
    bases = {
        "COMMAND": p.COMMAND_BASE,
        "REPLY": p.REPLY_BASE,
        "TARGET": p.SUMMARY_BASE,
        "SUMMARY": p.SUMMARY_BASE,
        "HEARTBEAT": p.HEARTBEAT_BASE,
    }
    seen = set()
    for message in database().messages:
        name, _, suffix = message.name.rpartition("_")
        device = p.Device[name]
        first = message.get_signal_by_name("Device")
        assert (message.length, first.start, first.length) == (8, 0, 8)
        assert first.minimum == first.maximum == device
        assert message.frame_id == bases.get(suffix, p.MEASUREMENT_BASE) + device
        seen.add((device, suffix))
    for device in p.Device:
        assert {(device, "COMMAND"), (device, "REPLY"), (device, "HEARTBEAT")} <= seen


@pytest.mark.parametrize(
    ("opcode", "arguments", "complaint"),
    [
        (0x7F, (), "0x7f is not in the protocol"),
        (p.Opcode.POWER, (), "POWER takes on"),
        (p.Opcode.POWER, (256,), "POWER"),
    ],
)
def test_L1_a_command_that_cannot_be_is_refused(
    opcode: int, arguments: tuple[int, ...], complaint: str
) -> None:
    with pytest.raises(p.CommandError, match=complaint):
        p.pack_command(p.Device.AXIS_RA, opcode, *arguments)


@given(st.integers(-(1 << 40), 1 << 40))
def test_B4_the_free_running_count_wraps(count: int) -> None:
    counts = p.unpack_tach(p.pack_tach(0x31, 0, count, 0)).counts
    assert (counts - count) % (1 << 32) == 0
    assert -(1 << 31) <= counts < 1 << 31
