"""Reports over a Unix socket in a folder of its own: both ways, who is refused, what is left."""

import os
import socket
import stat
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors.hid_unix import UnixDoor
from tests.scenarios.doors.served import StubClient
from tests.scenarios.doors.test_hid_uhid import Plug

REPORT = bytes(range(64))


class Desk:
    """An open door and those who call."""

    def __init__(self, path: Path) -> None:
        self.path, self.plug = path, Plug()
        self.callers: list[socket.socket] = []
        served: Any = SimpleNamespace(usb=SimpleNamespace(plug=lambda name: self.plug), now_ns=77)
        self.door = UnixDoor(str(path), served)
        self.door.open()

    def call(self) -> socket.socket:
        caller = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
        caller.connect(str(self.path))
        caller.setblocking(False)
        self.callers.append(caller)
        return caller


@pytest.fixture
def desk(tmp_path: Path) -> Iterator[Desk]:
    found = Desk(tmp_path / "hid")
    yield found
    found.door.close()
    for caller in found.callers:
        caller.close()


def test_reports_go_both_ways_to_all(desk: Desk) -> None:
    one, other = desk.call(), desk.call()
    one.send(REPORT)
    one.send(b"\0" + REPORT[::-1])
    other.send(REPORT[:10])
    desk.plug.waiting = [(1, REPORT), (2, REPORT)]
    desk.door.poll(0)
    desk.door.poll(0)
    assert desk.plug.written == [(77, REPORT), (77, REPORT[::-1])] and desk.door.rejected == 1
    for caller in (one, other):
        assert [caller.recv(100), caller.recv(100)] == [REPORT, REPORT]
    assert desk.door.state() == "2 programs, 1 were no reports of 64 bytes"


def test_while_the_gateway_is_busy_nothing_is_read(desk: Desk) -> None:
    desk.plug.room = 2
    caller = desk.call()
    for _ in range(4):
        caller.send(REPORT)
    desk.door.poll(0)
    desk.door.poll(0)
    assert len(desk.plug.written) == 2
    desk.plug.room = 100
    desk.door.poll(0)
    assert len(desk.plug.written) == 4


def test_sixteen_reports_are_taken_in_a_look_and_who_has_gone_is_forgotten(desk: Desk) -> None:
    client: Any = StubClient("", *[REPORT] * 20)
    plug: Any = desk.plug
    desk.door._take(client, plug)
    assert len(desk.plug.written) == 16
    desk.call().close()
    desk.door.poll(0)
    desk.door.poll(0)
    assert desk.door._clients.all == [] and desk.door._clients.came == 1


def test_its_socket_is_the_user_s_alone_and_goes_with_it(desk: Desk) -> None:
    mode = os.stat(desk.path).st_mode
    assert stat.S_ISSOCK(mode) and stat.S_IMODE(mode) == 0o600
    assert desk.door.name == f"--hid unix:{desk.path}"
    desk.door.close()
    assert not desk.path.exists() and not desk.plug.plugged
    desk.door.poll(0)
    desk.door.close()


def test_a_dead_server_s_socket_is_replaced_and_a_living_one_s_is_not(desk: Desk, tmp_path: Path) -> None:
    with pytest.raises(OSError, match=r"^--hid unix: .*hid: another server listens there$"):
        Desk(desk.path)
    dead = tmp_path / "dead"
    with socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET) as old:
        old.bind(str(dead))
    Desk(dead).door.close()
    (tmp_path / "file").write_text("kept")
    with pytest.raises(OSError, match=r"^--hid unix: .*file: exists and is no socket$"):
        Desk(tmp_path / "file")
    assert (tmp_path / "file").read_text() == "kept"
    with pytest.raises(OSError, match=r"^--hid unix: "):
        Desk(tmp_path / "none" / "hid")
