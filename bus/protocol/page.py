"""The protocol page in docs, from schmidt.dbc: `python -m bus.protocol.page` writes it, `--check` only
compares."""

import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from bus.protocol.names import SUMMARY_KIND, Device, device_named
from bus.protocol.nodes import KINDS, documented

PAGE_PATH = Path(__file__).parents[2] / "docs" / "protocol.md"
DBC_PATH = Path(__file__).with_name("final.dbc")
"""All boards in one file, for other people's tools; written beside the page."""
OTHERS = tuple(Device(number) for kind in KINDS for number in kind.nodes.values())
_INTRO = f"""# The protocol

Made from `bus/protocol/schmidt.dbc` and, for the boards that only the network `final` has,
`bus/protocol/nodes/*.dbc`, by `python -m bus.protocol.page`; change the DBC, not this page.
`bus/protocol/final.dbc`, written with it, has all boards in one file.

CAN 2.0A, standard identifiers, 1 Mbit/s unless a scenario says otherwise; every frame has eight bytes,
little endian, and byte 0 is the device type. In a 64-byte HID report bit 7 of byte 0 marks what is not a
measurement frame (identifier 0x200 + device type); byte 1 then tells which: an opcode (REPLY),
{SUMMARY_KIND:#04x} (SUMMARY, TARGET) or 0xf7 (HEARTBEAT).

A COMMAND is answered exactly once by the device's REPLY. A frame with an identifier nobody accepts is
acknowledged and ignored.
"""


def _everything() -> Any:
    return documented((*Device, *OTHERS))


def _family(name: str) -> str:
    return name.partition("_")[0]


def _suffix(name: str) -> str:
    return name.rpartition("_")[2]


def _devices() -> Iterator[str]:
    yield "\n## Devices\n"
    yield "| device | type | frames |\n|---|---|---|"
    for device in (*Device, *OTHERS):
        names = [
            message.name for message in _everything().messages if message.name.startswith(f"{device.name}_")
        ]
        frames = ", ".join(_suffix(name) for name in names if name == f"{device.name}_{_suffix(name)}")
        yield f"| {device.name} | {int(device):#04x} | {frames} |"


def _row(signal: Any) -> str:
    bits = f"{signal.start}" if signal.length == 1 else f"{signal.start}..{signal.start + signal.length - 1}"
    kind = f"{'i' if signal.is_signed else 'u'}{signal.length}"
    # Ranges that differ between the devices of a family (the device type itself) are in the table above.
    span = "see Devices" if signal.name == "Device" else f"{signal.minimum}..{signal.maximum}"
    choices = signal.choices if signal.choices and signal.name != "Device" else {}
    values = ", ".join(f"{number} {name}" for number, name in choices.items())
    text = " ".join(part for part in (signal.comment or "", values and f"({values})") if part)
    when = "" if signal.multiplexer_ids is None else f"{signal.multiplexer_ids[0]:#04x}"
    return f"| {when} | {signal.name} | {bits} | {kind} | {span} | {signal.unit or ''} | {text} |"


def _message(message: Any, devices: list[str]) -> Iterator[str]:
    base = message.frame_id - device_named(devices[0])
    period = f"every {message.cycle_time} ms" if message.cycle_time else "on demand"
    yield f"\n### {_family(message.name)} {_suffix(message.name)}: {base:#05x} + device type, {period}\n"
    yield f"{message.comment} Devices: {', '.join(devices)}.\n"
    yield "| opcode | signal | bits | type | range | unit | meaning |\n|---|---|---|---|---|---|---|"
    by_opcode = sorted(message.signals, key=lambda signal: (signal.multiplexer_ids or [-1], signal.start))
    yield from (_row(signal) for signal in by_opcode)


def page() -> str:
    """The whole page, Markdown. Messages that differ only in the device are shown once."""
    lines = [_INTRO.rstrip(), *_devices(), "\n## Frames"]
    shown: dict[tuple[str, str], tuple[Any, list[str]]] = {}
    for message in _everything().messages:
        device = message.name.rpartition("_")[0]
        key = _family(message.name), _suffix(message.name)
        shown.setdefault(key, (message, []))[1].append(device)
    for message, devices in shown.values():
        lines += _message(message, devices)
    return "\n".join(lines) + "\n"


def main(arguments: list[str]) -> int:
    """Write the page, or with `--check` return 1 when the one in docs is not what the DBC gives."""
    if arguments == ["--check"]:  # final.dbc: by what it says, tests/bus/protocol/test_nodes.py
        current = PAGE_PATH.exists() and PAGE_PATH.read_text(encoding="utf-8") == page()
        if not current:
            print(
                f"{PAGE_PATH}: not what schmidt.dbc gives; run python -m bus.protocol.page", file=sys.stderr
            )
        return 0 if current else 1
    PAGE_PATH.write_text(page(), encoding="utf-8")
    text: str = _everything().as_dbc_string(sort_signals=None).replace("\r\n", "\n")
    DBC_PATH.write_text(text, encoding="utf-8", newline="\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main(sys.argv[1:]))
