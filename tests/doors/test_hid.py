"""The gateway's USB outside of this process: a local socket, and uhid's own format."""

import os
import socket
import stat
from pathlib import Path

import pytest

from bus.protocol import Device, Opcode, pack_command
from bus.protocol.report import pack_report, unpack_report
from scenarios.doors.hid_uhid import UhidDoor, create_event
from scenarios.doors.hid_unix import UnixDoor
from scenarios.doors.usb import DESCRIPTOR, out_report
from tests.doors.conftest import Bench

PING = pack_report([pack_command(Device.FOCUS, Opcode.PING)])


def connect(path: Path) -> socket.socket:
    client = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    client.connect(str(path))
    client.setblocking(False)
    return client


def everything(client: socket.socket) -> list[bytes]:
    found = []
    while True:
        try:
            data = client.recv(4096)
        except BlockingIOError:
            return found
        if not data:
            return found
        found.append(data)


@pytest.mark.parametrize("report", [PING, b"\0" + PING], ids=["64 bytes", "65 bytes, report number first"])
def test_two_programs_on_the_socket_both_hear_the_answer(bench: Bench, tmp_path: Path, report: bytes) -> None:
    path = tmp_path / "gateway.sock"
    bench.open(UnixDoor(str(path), bench.served))
    assert stat.S_IMODE(os.stat(path).st_mode) == 0o600
    with connect(path) as one, connect(path) as two:
        bench.run(3)
        one.send(report)
        bench.run(50)
        for client in (one, two):
            reports = everything(client)
            assert all(len(each) == 64 for each in reports)
            identifiers = {frame.identifier for each in reports for frame in unpack_report(each)}
            assert 0x141 in identifiers


def test_odd_lengths_are_counted_and_a_program_that_dies_is_forgotten(bench: Bench, tmp_path: Path) -> None:
    door = UnixDoor(str(tmp_path / "s"), bench.served)
    bench.open(door)
    with connect(tmp_path / "s") as client:
        for length in (1, 63, 65, 66, 4000):
            client.send(b"\x01" * length)
        bench.run(20)
    bench.run(5)
    assert door.rejected == 5
    assert door.state() == "1 programs, 5 were no reports of 64 bytes"
    assert bench.all_tick()


def test_a_program_that_does_not_read_loses_reports_and_holds_nobody_up(bench: Bench, tmp_path: Path) -> None:
    door = UnixDoor(str(tmp_path / "s"), bench.served)
    bench.open(door)
    with connect(tmp_path / "s") as client:
        bench.run(4000)
        assert "lost by slow readers" in door.state()
        everything(client)
        bench.run(50)
        assert everything(client)


def test_a_socket_that_is_left_over_is_replaced_and_one_in_use_is_not(bench: Bench, tmp_path: Path) -> None:
    path = tmp_path / "s"
    old = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    old.bind(str(path))
    old.close()
    bench.open(UnixDoor(str(path), bench.served))
    with pytest.raises(OSError, match="another server"):
        UnixDoor(str(path), bench.served).open()
    (tmp_path / "file").write_text("mine")
    with pytest.raises(OSError, match="no socket"):
        UnixDoor(str(tmp_path / "file"), bench.served).open()


def test_the_65_byte_trap() -> None:
    assert out_report(b"\0" + PING) == PING
    assert out_report(PING) == PING
    assert out_report(b"\x01" + PING) is None
    assert out_report(b"") is None


def test_the_create_event_is_the_kernels() -> None:
    # struct uhid_event of include/uapi/linux/uhid.h: u32 type and a packed union, create2 its largest member
    event = create_event()
    assert len(event) == 4 + 128 + 64 + 64 + 2 + 2 + 4 * 4 + 4096
    assert event[:4] == (11).to_bytes(4, "little")
    assert event[260:262] == len(DESCRIPTOR).to_bytes(2, "little")
    assert event[262:264] == (3).to_bytes(2, "little"), "BUS_USB"
    assert event[264:272] == (0x04D8).to_bytes(4, "little") + (0x003F).to_bytes(4, "little")
    assert event[280 : 280 + len(DESCRIPTOR)] == DESCRIPTOR


def test_without_uhid_the_error_says_what_works(bench: Bench) -> None:
    with pytest.raises(OSError, match="unix:PATH works without it"):
        UhidDoor(bench.served, "/dev/no-such-uhid").open()
