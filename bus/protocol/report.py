"""The 64-byte USB HID report between gateway and PC: eight slots of eight frame bytes, byte 0 names the
device.

Each of the paper's eight measuring nodes has a place of its own (row L2), the same in every report. What else
there is to say takes the places that are free.

There is no room for identifiers. Bit 7 of byte 0 marks what is not a 0x200+D measurement. Byte 1 then
tells a REPLY (an opcode, below 0x80) from a SUMMARY or TARGET (0xF3) and a HEARTBEAT (0xF7). A slot
whose byte 0 is 0 is empty.
"""

from collections.abc import Iterator, Sequence
from typing import Final

from bus.can.frame import Frame
from bus.protocol.names import (
    COMMAND_BASE,
    FRAME_BYTES,
    HEARTBEAT_BASE,
    HEARTBEAT_KIND,
    MEASUREMENT_BASE,
    REPLY_BASE,
    SUMMARY_BASE,
    SUMMARY_KIND,
    Device,
)

REPORT_BYTES: Final = 64
SLOTS: Final = REPORT_BYTES // FRAME_BYTES
_NOT_MEASUREMENT: Final = 0x80
PLACES: Final[dict[int, int]] = {
    int(device): place
    for place, device in enumerate(
        (
            Device.POSITION_RA,
            Device.POSITION_DEC,
            Device.AXIS_RA,
            Device.AXIS_DEC,
            Device.MOTOR_RA_A,
            Device.MOTOR_RA_B,
            Device.MOTOR_DEC_A,
            Device.MOTOR_DEC_B,
        )
    )
}
"""Whose measurement is where. ASSUMPTION: the order of the paper's list."""
_KINDS: Final = {SUMMARY_KIND: SUMMARY_BASE, HEARTBEAT_KIND: HEARTBEAT_BASE}


class ReportError(ValueError):
    """A report, or a frame for one, that the gateway's map has no place for."""


def slot(frame: Frame) -> bytes:
    """The eight bytes of `frame` in a report to the PC; raises ReportError for one outside the protocol."""
    identifier, data = frame.identifier, frame.data
    if len(data) != FRAME_BYTES or not 0 < data[0] < _NOT_MEASUREMENT:
        raise ReportError(f"frame {identifier:#05x} with data {data.hex(' ')} has no slot in a HID report")
    base = identifier - data[0]
    if base == MEASUREMENT_BASE:
        return data
    if base != REPLY_BASE and _KINDS.get(data[1]) != base:
        raise ReportError(f"frame {identifier:#05x} with data {data.hex(' ')} says another kind")
    kind = data[1] & 0x7F if base == REPLY_BASE else data[1]
    return bytes((data[0] | _NOT_MEASUREMENT, kind)) + data[2:]


def pack_report(slots: Sequence[bytes]) -> bytes:
    """A report of up to eight slots; the unused ones are zero."""
    if len(slots) > SLOTS:
        raise ReportError(f"{len(slots)} slots do not fit a HID report of {SLOTS}")
    return b"".join(slots).ljust(REPORT_BYTES, b"\0")


def place(waiting: Sequence[bytes]) -> bytes:
    """A report to the PC of up to eight slots, oldest first; of two measurements of one node the newer."""
    placed: dict[int, bytes] = {}
    others: list[bytes] = []
    for data in waiting:
        at = PLACES.get(data[0])
        if at is None:
            others.append(data)
        else:
            placed[at] = data
    rest = iter(others)
    return b"".join(placed.get(at) or next(rest, bytes(FRAME_BYTES)) for at in range(SLOTS))


def _slots(report: bytes) -> Iterator[bytes]:
    if len(report) != REPORT_BYTES:
        raise ReportError(f"HID report has {len(report)} bytes, expected {REPORT_BYTES}")
    for start in range(0, REPORT_BYTES, FRAME_BYTES):
        if report[start]:
            yield report[start : start + FRAME_BYTES]


def unpack_report(report: bytes) -> list[Frame]:
    """Frames of a report from the gateway, with the identifiers they had on the bus; raises ReportError."""
    frames = []
    for data in _slots(report):
        device, base = data[0], MEASUREMENT_BASE
        if device & _NOT_MEASUREMENT:
            device &= ~_NOT_MEASUREMENT
            data = bytes((device,)) + data[1:]
            base = REPLY_BASE if data[1] < _NOT_MEASUREMENT else _KINDS.get(data[1], 0)
            if not base:
                raise ReportError(f"HID report slot {data.hex(' ')}: kind {data[1]:#04x} is unknown")
        frames.append(Frame(base + device, data))
    return frames


def unpack_commands(report: bytes) -> list[Frame]:
    """COMMAND frames of a report from the PC: every used slot goes to 0x080 + its device type."""
    return [Frame(COMMAND_BASE + (data[0] & 0x7F), data) for data in _slots(report)]
