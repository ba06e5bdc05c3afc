"""The five RS232 lines as pseudo-terminals and over TCP, read by pyserial."""

import socket
from pathlib import Path
from time import monotonic

import pytest
import serial

from bus.protocol.serial import PacketDecoder
from scenarios.doors.lines import Feed
from scenarios.doors.serial_pty import PtyDoor
from scenarios.doors.serial_tcp import TcpDoor
from tests.doors.conftest import MS, Bench
from tests.ports import free_ports

BOARDS = ["AXIS_RA", "POSITION_RA", "AXIS_DEC", "POSITION_DEC", "FOCUS"]


def test_bytes_come_at_the_pace_of_the_line(bench: Bench) -> None:
    feed = bench.served.lines.feed("AXIS_RA")
    whole = bench.served.lines.feed("AXIS_RA")
    uart = bench.served.lines.uarts["AXIS_RA"]
    ends: list[tuple[int, bytes]] = []
    uart.sink = lambda t_ns, packet: ends.append((t_ns, packet))
    most, stream = 0, b""
    for _ in range(4500):
        bench.slice(MS // 10)
        data = feed.until(bench.served.now_ns)
        most = max(most, len(data))
        stream += data
    assert most <= 2, "115 200 baud are 11.5 bytes a millisecond"
    packet = ends[0][1]
    assert stream.startswith(packet)
    assert whole.until(ends[0][0] - 1) == packet[:-1], "the last stop bit is over when the packet is through"
    assert whole.until(ends[0][0]) == packet[-1:]


def test_a_feed_that_nobody_empties_keeps_the_latest(bench: Bench) -> None:
    feed: Feed = bench.served.lines.feed("FOCUS")
    bench.served.run_until(30_000 * MS)
    decoder = PacketDecoder()
    packets = decoder.feed(feed.until(bench.served.now_ns))
    assert len(packets) >= 60
    assert decoder.crc_errors == 0


def test_pseudo_terminals_have_stable_names_and_pyserial_reads_them(bench: Bench, tmp_path: Path) -> None:
    door = PtyDoor(str(tmp_path / "ports"), bench.served)
    keeper = bench.open(door)
    assert sorted(path.name for path in (tmp_path / "ports").iterdir()) == sorted(BOARDS)
    bench.run(300)
    assert not door.state()
    with serial.Serial(str(tmp_path / "ports" / "AXIS_RA"), 115_200, timeout=0) as port:
        decoder, packets = PacketDecoder(), []
        for _ in range(1200):
            bench.slice()
            packets += decoder.feed(port.read(4096))
        port.write(b"\x03anything\n" * 100)  # the board has no receiver
        bench.run(5)
        assert door.ports[0].in_use
        assert len(packets) >= 3
        assert {packet.device for packet in packets} == {0x11}
    bench.run(5)
    assert not door.ports[0].in_use
    keeper.close()
    assert door.state() == f"{door.ports[0].heard} bytes read at AXIS_RA"
    assert list((tmp_path / "ports").iterdir()) == []


def test_a_reader_that_stops_reading_loses_bytes_and_holds_nobody_up(bench: Bench, tmp_path: Path) -> None:
    door = PtyDoor(str(tmp_path), bench.served)
    bench.open(door)
    with serial.Serial(str(tmp_path / "AXIS_RA"), timeout=0) as port:
        bench.run(12_000)
        assert door.ports[0].lost > 0
        stale = port.read(100_000)
        assert 0 < len(stale) < 60_000
        bench.run(500)
        assert PacketDecoder().feed(port.read(100_000)), "and goes on reading afterwards"
    with serial.Serial(str(tmp_path / "AXIS_RA"), timeout=0) as port:
        bench.run(2)
        assert len(port.read(100_000)) < 100, "a port that is opened holds nothing old"


def test_a_name_that_is_taken_by_a_file_is_refused(bench: Bench, tmp_path: Path) -> None:
    (tmp_path / "FOCUS").write_text("mine")
    with pytest.raises(OSError, match="FOCUS exists"):
        PtyDoor(str(tmp_path), bench.served).open()
    assert sorted(path.name for path in tmp_path.iterdir()) == ["FOCUS"]
    assert (tmp_path / "FOCUS").read_text() == "mine"


def test_tcp_serves_several_readers_and_survives_one_that_goes(bench: Bench) -> None:
    base = free_ports(5)
    door = TcpDoor(str(base), bench.served)
    bench.open(door)
    with (
        serial.serial_for_url(f"socket://127.0.0.1:{base + 1}", timeout=0) as first,
        socket.create_connection(("127.0.0.1", base + 1)) as second,
    ):
        bench.run(600)
        second.close()
        bench.run(600)
        decoder, packets = PacketDecoder(), []
        end_s = monotonic() + 10.0
        while len(packets) < 3:  # a read may bring less than has been sent
            assert monotonic() < end_s
            packets += decoder.feed(first.read(100_000))
        assert {packet.device for packet in packets} == {0x21}
    with pytest.raises(OSError, match="cannot be listened on"):
        TcpDoor(str(base), bench.served).open()
