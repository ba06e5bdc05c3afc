"""RS232 packets of 25 samples, which a board takes every 10 ms and sends at once.

    sync AA 55 | device type u8 | sequence u8 | time stamp u32 | 25 samples | CRC-16 u16      (little endian)

The time stamp is the board's own clock at the first sample, units of 100 µs, modulo 2**32 (five days).
CRC-16: polynomial 0x1021, initial 0xFFFF, not reflected, no final XOR ("CCITT-FALSE"), over everything
between sync and CRC. Layouts and CRC are ASSUMPTIONS; the paper gives the period, the 25 samples and the
quantities (row L3). A board sends each part when it has it: the head with the first sample.
"""

import re
from binascii import crc_hqx
from collections.abc import Collection, Sequence
from itertools import starmap
from struct import Struct, calcsize, error
from typing import Final, NamedTuple

from bus.protocol.names import Device
from bus.protocol.saturate import Clip, fitted, nobody

SYNC: Final = b"\xaa\x55"
STAMP_UNIT_NS: Final = 100_000
SAMPLE_NS: Final = 10_000_000
PACKET_NS: Final = 250_000_000
SAMPLES: Final = 25
NO_SETPOINT: Final = -(1 << 31)
"""Set point of an axis in open loop: there is none."""
_CRC_START: Final = 0xFFFF
_CODES: Final = re.compile(r"(\d*)([a-zA-Z])")
_head: Final = Struct("<BBI")
_crc: Final = Struct("<H")


class AxisSample(NamedTuple):
    """One 10 ms sample of an axis board; units in `MEANINGS`."""

    effort: int
    position: int
    velocity: int
    adc_a: int
    adc_b: int
    tach_a: int
    tach_b: int
    aux: int
    setpoint: int


MEANINGS: Final = {
    "effort": "1/3000 of the supply",
    "position": "steps of the absolute encoder, 29 bit",
    "velocity": "counts of the incremental encoder in the last 5 ms",
    "adc_a": "current of motor A, 10-bit counts",
    "adc_b": "current of motor B, 10-bit counts",
    "tach_a": "counts of motor A in the last 10 ms",
    "tach_b": "counts of motor B in the last 10 ms",
    "aux": "counts of the auxiliary encoder, 17 bit",
    "setpoint": f"Q16 counts per 5 ms; {NO_SETPOINT} in open loop",
    "half_steps": "commanded, half steps",
    "encoder": "counts of the focus encoder",
    "lvdt": "10-bit counts",
    **{f"byte{k}": f"byte {k} of the measurement frame, see the board's DBC" for k in range(1, 8)},
}
"""Field of a sample -> unit and meaning, for the protocol's page."""

_Layout = tuple[Struct, tuple[str, ...]]
"""Of a sample, and the names of its fields."""
_AXIS: Final[_Layout] = (Struct("<hIhHHhhIi"), AxisSample._fields)
_POSITION: Final[_Layout] = (Struct("<I"), ("position",))
_LAYOUTS: Final[dict[int, _Layout]] = {
    Device.AXIS_RA: _AXIS,
    Device.AXIS_DEC: _AXIS,
    Device.POSITION_RA: _POSITION,
    Device.POSITION_DEC: _POSITION,
    Device.FOCUS: (Struct("<hhH"), ("half_steps", "encoder", "lvdt")),
}
"""The five boards with a serial line (L3)."""
_FRAME: Final[_Layout] = (Struct("<7B"), tuple(f"byte{k}" for k in range(1, 8)))
"""A declared board's measurement frame: its bytes 1..7, to be read by the board's DBC."""
_WRITTEN: Final = frozenset(Device)
"""Every other device type is a declared board's."""


class SerialError(ValueError):
    """A packet that cannot be built."""


class Packet(NamedTuple):
    """stamp: board clock at the first sample, 100 µs units, modulo 2**32; rows: the numbers of 25 samples,
    10 ms apart."""

    device: int
    sequence: int
    stamp: int
    rows: tuple[tuple[int, ...], ...]


def packet_bytes(device: int) -> int:
    """Length of a packet of `device`, sync and CRC included; raises SerialError for one without a line."""
    return len(SYNC) + _head.size + SAMPLES * _known(device)[0].size + _crc.size


def ahead_bytes(device: int) -> int:
    """Bytes of a packet that have left before its last sample is taken; SerialError as above."""
    return len(SYNC) + _head.size + (SAMPLES - 1) * _known(device)[0].size


def fields(device: int) -> list[tuple[str, str, int]]:
    """Name, type (`i16`) and first byte of what a sample of `device` holds; SerialError as above."""
    layout, names = _known(device)
    codes = [code for count, code in _CODES.findall(layout.format) for _ in range(int(count or 1))]
    at, found = 0, []
    for name, code in zip(names, codes, strict=True):
        size = calcsize(f"<{code}")
        found.append((name, f"{'i' if code.islower() else 'u'}{8 * size}", at))
        at += size
    return found


def _known(device: int) -> _Layout:
    if device in _WRITTEN and device not in _LAYOUTS:
        raise SerialError(f"device type {device:#04x} has no serial line")
    return _LAYOUTS.get(device, _FRAME)


def pack_packet(
    device: int, sequence: int, stamp: int, samples: Sequence[Sequence[int]], clip: Clip = nobody
) -> bytes:
    """A packet; sequence and stamp are taken modulo their width, samples are cut to theirs (`clip` is told).

    Raises SerialError for a device without a serial line and a wrong number of samples.
    """
    if len(samples) != SAMPLES:
        raise SerialError(f"a packet holds {SAMPLES} samples, got {len(samples)}")
    body = pack_head(device, sequence, stamp) + pack_rows(device, samples, clip)
    return body + _crc.pack(crc_hqx(body[len(SYNC) :], _CRC_START))


def pack_head(device: int, sequence: int, stamp: int) -> bytes:
    """What stands before the samples of a packet."""
    return SYNC + _head.pack(device, sequence & 0xFF, stamp & 0xFFFF_FFFF)


def pack_rows(device: int, samples: Sequence[Sequence[int]], clip: Clip = nobody) -> bytes:
    """Samples of a packet, cut to their fields; raises SerialError for a device without a serial line."""
    layout = _known(device)[0]
    try:
        return b"".join(starmap(layout.pack, samples))
    except error:
        clip()
        return b"".join(layout.pack(*fitted(layout, sample)) for sample in samples)


class PacketDecoder:
    """Finds packets in a byte stream, however it is cut. declared: types of declared boards on this line.

    A wrong CRC or unknown device type costs the sync it started with; the search goes on one byte later.
    """

    def __init__(self, declared: Collection[int] = ()) -> None:
        self._devices = {*_LAYOUTS, *declared}
        self.crc_errors = 0
        self.skipped_bytes = 0
        self._buffer = bytearray()

    def feed(self, data: bytes) -> list[Packet]:
        """Take more of the stream; returns the packets completed by it."""
        buffer = self._buffer
        buffer += data
        packets: list[Packet] = []
        while self._seek() and len(buffer) > len(SYNC):
            device = buffer[len(SYNC)]
            if device not in self._devices:
                self._skip(1)
                continue
            length = packet_bytes(device)
            if len(buffer) < length:
                break
            body = bytes(buffer[len(SYNC) : length - _crc.size])
            if _crc.unpack_from(buffer, length - _crc.size)[0] != crc_hqx(body, _CRC_START):
                self.crc_errors += 1
                self._skip(1)
                continue
            packets.append(_decode(body))
            del buffer[:length]
        return packets

    def _seek(self) -> bool:
        """Drop everything before the next sync; False when it is not (all) there yet."""
        start = self._buffer.find(SYNC)
        if start < 0:
            start = len(self._buffer) - self._buffer.endswith(SYNC[:1])
            self._skip(start)
            return False
        self._skip(start)
        return True

    def _skip(self, count: int) -> None:
        self.skipped_bytes += count
        del self._buffer[:count]


def _decode(body: bytes) -> Packet:
    device, sequence, stamp = _head.unpack_from(body)
    return Packet(device, sequence, stamp, tuple(_known(device)[0].iter_unpack(body[_head.size :])))
