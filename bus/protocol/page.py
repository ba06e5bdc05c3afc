"""The protocol's page, from the DBC files; `python -m docs.generate` writes it, and `final.dbc`."""

from collections.abc import Iterator
from dataclasses import astuple
from pathlib import Path
from typing import Any

from bus.protocol.names import FRAME_BYTES, HEARTBEAT_KIND, SUMMARY_KIND, Device
from bus.protocol.nodes import DEVICES, KINDS, documented
from bus.protocol.report import PLACES
from bus.protocol.serial import MEANINGS, SAMPLES, SYNC, fields, packet_bytes

DBC_PATH = Path(__file__).with_name("final.dbc")
"""All boards in one file, for other people's tools."""
_TYPE = 0x7F
"""Bits of an identifier that are the device type."""
_TEXT = Path(__file__).with_suffix(".md")
"""The page's words; its tables are filled in."""


def _everything() -> Any:
    return documented(DEVICES)


def _family(name: str) -> str:
    return name.partition("_")[0]


def _suffix(name: str) -> str:
    return name.rpartition("_")[2]


def _devices() -> Iterator[str]:
    for device in DEVICES:
        names = [
            message.name for message in _everything().messages if message.name.startswith(f"{device.name}_")
        ]
        frames = ", ".join(_suffix(name) for name in names if name == f"{device.name}_{_suffix(name)}")
        yield f"| {device.name} | {int(device):#04x} | {frames} |"


def _parameters() -> Iterator[str]:
    for kind in KINDS:
        for number, name, low, high, default in map(astuple, kind.parameters):
            yield f"| {kind.name} | {number} | {name.upper()} | {low}..{high} | {default} |"


def _row(signal: Any) -> str:
    bits = f"{signal.start}" if signal.length == 1 else f"{signal.start}..{signal.start + signal.length - 1}"
    kind = f"{'i' if signal.is_signed else 'u'}{signal.length}"
    # Ranges that differ between the devices of a family (the device type itself) are in the table above.
    span = "see Devices" if signal.name == "Device" else f"{signal.minimum}..{signal.maximum}"
    choices = signal.choices if signal.choices and signal.name != "Device" else {}
    values = ", ".join(f"{number} {name}" for number, name in choices.items())
    text = " ".join(part for part in (signal.comment or "", values and f"(`{values}`)") if part)
    when = "" if signal.multiplexer_ids is None else f"{signal.multiplexer_ids[0]:#04x}"
    return f"| {when} | {signal.name} | {bits} | {kind} | {span} | {signal.unit or ''} | {text} |"


def _message(message: Any, devices: list[str]) -> Iterator[str]:
    base = message.frame_id & ~_TYPE
    period = f"every {message.cycle_time} ms" if message.cycle_time else "on demand"
    yield f"\n### {_family(message.name)} {_suffix(message.name)}: {base:#05x} + device type, {period}\n"
    yield f"{message.comment} Devices: {', '.join(devices)}.\n"
    yield "| opcode | signal | bits | type | range | unit | meaning |\n|---|---|---|---|---|---|---|"
    by_opcode = sorted(message.signals, key=lambda signal: (signal.multiplexer_ids or [-1], signal.start))
    yield from (_row(signal) for signal in by_opcode)


def _in_short(messages: list[Any]) -> Iterator[str]:
    """Rows: identifier, frame, period, signals in their order; boards that have the same frame in one row."""
    rows: dict[tuple[str, ...], list[str]] = {}
    for message in messages:
        period = f"{message.cycle_time} ms" if message.cycle_time else "on demand"
        own = [each for each in message.signals if each.name != "Device" and not each.multiplexer_ids]
        signals = ", ".join(signal.name for signal in sorted(own, key=lambda signal: signal.start))
        key = f"{message.frame_id & ~_TYPE:#05x}", _suffix(message.name), period, signals
        rows.setdefault(key, []).append(_family(message.name))
    everyone = max(map(len, rows.values()))
    for (base, kind, period, signals), families in rows.items():
        boards = "every board" if len(families) == everyone else ", ".join(families)
        yield f"| {base} | {kind} | {boards} | {period} | {signals} |"


def _places() -> Iterator[str]:
    for device, place in PLACES.items():
        first = place * FRAME_BYTES
        yield f"| {place} | {first}..{first + FRAME_BYTES - 1} | {Device(device).name} ({device:#04x}) |"


def _samples() -> Iterator[str]:
    like = {
        "an axis board": Device.AXIS_RA,
        "a position board": Device.POSITION_RA,
        "the focus": Device.FOCUS,
    }
    for who, device in (like | {"a declared board with a line": 0x7F}).items():
        rows = fields(device)
        yield f"\n### Sample of {who}; a packet has {packet_bytes(device)} bytes\n"
        yield "| bytes | field | type | meaning |\n|---|---|---|---|"
        for name, kind, first in rows:
            last = first + int(kind[1:]) // 8 - 1
            yield f"| {first if first == last else f'{first}..{last}'} | {name} | {kind} | {MEANINGS[name]} |"


def page() -> str:
    """The whole page, Markdown. Messages that differ only in the device are shown once."""
    shown: dict[tuple[str, str], tuple[Any, list[str]]] = {}
    for message in _everything().messages:
        device = message.name.rpartition("_")[0]
        key = _family(message.name), _suffix(message.name)
        shown.setdefault(key, (message, []))[1].append(device)
    frames = (line for each in shown.values() for line in _message(*each))
    tables = {
        "devices": _devices(), "short": _in_short([message for message, _ in shown.values()]),
        "parameters": _parameters(), "places": _places(), "fields": _samples(), "frames": frames,
    }  # fmt: skip
    return _TEXT.read_text(encoding="utf-8").format(
        summary=SUMMARY_KIND,
        heartbeat=HEARTBEAT_KIND,
        sync=SYNC.hex(" "),
        samples=SAMPLES,
        **{name: "\n".join(lines) for name, lines in tables.items()},
    )
