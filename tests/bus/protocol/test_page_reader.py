"""A reader written from docs/reference/protocol.md alone, against what the boards of the lab send."""

import struct
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import pytest

from bus.protocol import Device
from scenarios.lab.wiring import network

# --- the reader: nothing of ours ---------------------------------------------------------------------
SAMPLE = {0x1: "<hIhHHhhIi", 0x2: "<I", 0x4: "<hhH"}
PLACES = (0x21, 0x22, 0x11, 0x12, 0x31, 0x32, 0x33, 0x34)


def crc16(data: bytes) -> int:
    crc = 0xFFFF
    for byte in data:
        crc ^= byte << 8
        for _ in range(8):
            crc = (crc << 1 ^ (0x1021 if crc & 0x8000 else 0)) & 0xFFFF
    return crc


def packets(stream: bytes) -> Iterator[tuple[int, int, int, list[Any]]]:
    """Device type, sequence, stamp, 25 samples."""
    at = 0
    while (at := stream.find(b"\xaa\x55", at)) >= 0 and at + 8 <= len(stream):
        layout = SAMPLE.get(stream[at + 2] >> 4)
        end = at + 8 + 25 * struct.calcsize(layout or "")
        if layout and stream[end : end + 2] == crc16(stream[at + 2 : end]).to_bytes(2, "little"):
            yield (
                *struct.unpack_from("<BBI", stream, at + 2),
                [*struct.iter_unpack(layout, stream[at + 8 : end])],
            )
            at = end + 2
        else:
            at += 1


def reports(report: bytes) -> Iterator[tuple[int, int, str, bytes]]:
    """Place, device type, kind and eight bytes."""
    for place in range(8):
        data = report[8 * place : 8 * place + 8]
        kind = {0xF3: "SUMMARY", 0xF7: "HEARTBEAT"}.get(data[1], "REPLY") if data[0] & 0x80 else "MEASUREMENT"
        if data[0]:
            yield place, data[0] & 0x7F, kind, data


# -----------------------------------------------------------------------------------------------------

Heard = tuple[dict[int, bytes], list[bytes]]


@pytest.fixture(scope="module")
def heard() -> Heard:
    """Serial streams by device type, HID reports, after two seconds and two commands."""
    made = network()
    streams: dict[int, bytearray] = {}
    taken: list[bytes] = []
    for name, uart in made.uarts.items():
        stream = streams.setdefault(int(Device[name]), bytearray())
        uart.sink = lambda _t, data, into=stream: into.extend(data)
    made.hid.to_host = lambda _t, report: taken.append(report)
    made.queue.run_until(1_000_000_000)
    command = bytes((0x11, 0x01, 0, 0, 0, 0, 0, 0)), bytes((0x61, 0x02, 1, 0, 0, 0, 0, 0))
    made.hid.write(made.queue.now_ns, b"".join(command).ljust(64, b"\0"))
    made.queue.run_until(2_000_000_000)
    return {device: bytes(stream) for device, stream in streams.items()}, taken


def test_L3_packets_are_read_by_the_page_alone(heard: Heard) -> None:
    streams, _ = heard
    assert sorted(streams) == [0x11, 0x12, 0x21, 0x22, 0x41]
    for device, stream in streams.items():
        found = list(packets(b"\x55\xaa\xaa" + stream))
        assert [each[:2] for each in found] == [(device, k) for k in range(len(found))]
        assert len(found) in (7, 8)
        stamps = [stamp for _, _, stamp, _ in found]
        assert all(abs(b - a - 2500) <= 2 for a, b in pairwise(stamps))
        assert {len(samples) for *_, samples in found} == {25}
    # the axis repeats the position board's place: its samples are those of the other line
    axis = [row[1] for *_, rows in packets(streams[0x11]) for row in rows]
    place = {row[0] for *_, rows in packets(streams[0x21]) for row in rows}
    assert axis[-1] in range(min(place) - 5, max(place) + 6)


def test_B7_L2_every_node_has_its_place(heard: Heard) -> None:
    _, taken = heard
    seen: dict[int, set[int]] = {}
    kinds: dict[str, set[int]] = {}
    for report in taken:
        for place, device, kind, _ in reports(report):
            kinds.setdefault(kind, set()).add(device)
            if kind == "MEASUREMENT":
                seen.setdefault(device, set()).add(place)
    assert {device: seen[device] for device in PLACES} == {
        device: {place} for place, device in enumerate(PLACES)
    }
    assert kinds["HEARTBEAT"] == {int(device) for device in Device}
    assert kinds["SUMMARY"] == {0x11, 0x12, 0x21, 0x22}
    assert kinds["REPLY"] == {0x11, 0x61}
    answered = [data for report in taken for _, _, kind, data in reports(report) if kind == "REPLY"]
    assert [data[2] for data in answered if data[0] & 0x7F == 0x11] == [0]  # PING: OK
