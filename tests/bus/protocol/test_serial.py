from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.protocol import Device
from bus.protocol.serial import (
    MEANINGS,
    NO_SETPOINT,
    PACKET_NS,
    SAMPLE_NS,
    SAMPLES,
    STAMP_UNIT_NS,
    SYNC,
    AxisSample,
    PacketDecoder,
    SerialError,
    ahead_bytes,
    fields,
    pack_packet,
    packet_bytes,
)

i16, u16 = st.integers(-(1 << 15), (1 << 15) - 1), st.integers(0, (1 << 16) - 1)
i32, u32 = st.integers(-(1 << 31), (1 << 31) - 1), st.integers(0, (1 << 32) - 1)
ROWS: dict[int, Any] = {
    Device.AXIS_RA: st.tuples(i16, u32, i16, u16, u16, i16, i16, u32, i32),
    Device.POSITION_DEC: st.tuples(u32),
    Device.FOCUS: st.tuples(i16, i16, u16),
}


@st.composite
def packets(draw: Any) -> tuple[int, int, int, list[tuple[int, ...]]]:
    device = draw(st.sampled_from(sorted(ROWS)))
    row = draw(ROWS[device])
    rows = [tuple(row) for _ in range(SAMPLES)]
    rows[draw(st.integers(0, SAMPLES - 1))] = tuple(draw(ROWS[device]))
    return device, draw(st.integers(0, 255)), draw(u32), rows


@given(st.lists(packets(), max_size=3), st.binary(max_size=20), st.lists(st.integers(1, 700), max_size=30))
def test_L3_however_the_stream_is_cut_the_packets_are_the_same(
    batch: list[Any], noise: bytes, cuts: list[int]
) -> None:
    noise = noise.replace(SYNC, b"")
    if noise.endswith(SYNC[:1]):
        noise += b"\0"
    stream = b"".join(noise + pack_packet(*packet) for packet in batch)
    at_once = PacketDecoder().feed(stream)
    assert [(p.device, p.sequence, p.stamp, [tuple(s) for s in p.rows]) for p in at_once] == batch
    bytewise, pieces = PacketDecoder(), PacketDecoder()
    assert [p for byte in stream for p in bytewise.feed(bytes([byte]))] == at_once
    found, start = [], 0
    for cut in [*cuts, len(stream)]:
        found += pieces.feed(stream[start : start + cut])
        start += cut
    assert found == at_once
    assert bytewise.skipped_bytes == pieces.skipped_bytes == len(noise) * len(batch)


@given(packets(), st.data())
def test_L3_one_wrong_byte_costs_one_packet_and_is_counted(packet: Any, data: Any) -> None:
    good = pack_packet(*packet)
    index = data.draw(st.integers(8, len(good) - 1))  # past sync and device type
    bad = bytearray(good)
    bad[index] ^= data.draw(st.integers(1, 255))
    decoder = PacketDecoder()
    found = decoder.feed(bytes(bad) + good + good)
    assert len(found) == 2
    assert decoder.crc_errors >= 1


def test_L3_the_crc_is_the_one_stated() -> None:
    from binascii import crc_hqx

    assert crc_hqx(b"123456789", 0xFFFF) == 0x29B1  # published check value of CRC-16/CCITT-FALSE


def test_L3_axis_packets_fit_their_line() -> None:
    # 250 ms at 57 600 bit/s, ten bits a byte, is 1440 bytes.
    assert packet_bytes(Device.AXIS_RA) == 2 + 6 + 25 * 24 + 2 < 1440
    assert AxisSample._fields[:3] == ("effort", "position", "velocity")


@pytest.mark.parametrize(
    ("device", "rows", "complaint"),
    [(0x31, [(0,)] * 25, "0x31 has no serial line"), (0x21, [(0,)], "25 samples, got 1")],
)
def test_L3_packets_that_cannot_be_are_refused(device: int, rows: list[tuple[int]], complaint: str) -> None:
    with pytest.raises(SerialError, match=complaint):
        pack_packet(device, 0, 0, rows)


@pytest.mark.parametrize(
    ("device", "types"),
    [
        (Device.AXIS_DEC, ("i16", "u32", "i16", "u16", "u16", "i16", "i16", "u32", "i32")),
        (Device.POSITION_RA, ("u32",)),
        (Device.FOCUS, ("i16", "i16", "u16")),
        (0xEE, ("u8",) * 7),
    ],
)
def test_L3_fields_stand_one_behind_the_other(device: int, types: tuple[str, ...]) -> None:
    """As the page tells them; ten of a packet's bytes are head and CRC."""
    found, at = fields(device), 0
    for (name, kind, place), wanted in zip(found, types, strict=True):
        assert (kind, place) == (wanted, at), name
        at += int(wanted[1:]) // 8
    assert all(MEANINGS[name] for name, _, _ in found)
    assert packet_bytes(device) == 10 + SAMPLES * at
    if device == 0xEE:
        assert [name for name, _, _ in found] == [f"byte{k}" for k in range(1, 8)]


def test_a_packets_times_are_the_papers() -> None:
    """Row L3: every 250 ms the last 25 samples, taken at 10 ms; the stamp counts 100 µs."""
    assert (SAMPLES, SAMPLE_NS, PACKET_NS, STAMP_UNIT_NS) == (25, 10_000_000, 250_000_000, 100_000)
    assert NO_SETPOINT == -0x8000_0000


@pytest.mark.parametrize(("device", "size"), [(Device.AXIS_RA, 24), (Device.POSITION_RA, 4), (0x41, 6)])
def test_all_but_the_last_sample_and_the_crc_leave_ahead(device: int, size: int) -> None:
    """Sync 2, head 6, then 24 samples; with the last one and the CRC the packet is whole."""
    assert ahead_bytes(device) == 2 + 6 + 24 * size == packet_bytes(device) - size - 2


def test_every_field_has_a_meaning_and_no_meaning_is_without_one() -> None:
    devices = (Device.AXIS_RA, Device.POSITION_RA, Device.FOCUS, 0x7F)
    assert set(MEANINGS) == {name for device in devices for name, _, _ in fields(device)}
