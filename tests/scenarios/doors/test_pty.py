"""Boards' lines as pseudo-terminals in a folder of their own: names, readers that come and go, slow ones."""

import os
import select
from collections.abc import Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import serial_pty
from scenarios.doors.serial_pty import DebugDoor, DebugFeed, PtyDoor, PtyPort


class Source:
    """A feed that has what it was given."""

    def __init__(self) -> None:
        self.data = b""

    def until(self, _now_ns: int) -> bytes:
        data, self.data = self.data, b""
        return data


def read(number: int, count: int) -> bytes:
    """So many bytes, however long the kernel takes for them."""
    found = b""
    while len(found) < count and select.select([number], [], [], 5.0)[0]:
        found += os.read(number, count)
    return found


class Line:
    """A port and its feed; taken: what a program has sent."""

    def __init__(self, link: Path) -> None:
        feed: Any = Source()
        self.feed = feed
        self.taken: list[bytes] = []
        self.port = PtyPort(link, feed, self.taken.append)

    def look(self, data: bytes = b"", wait_ms: int = 0) -> None:
        """wait_ms: until something is there; the kernel hands bytes over when it likes."""
        poll = select.poll()
        poll.register(self.port.number, select.POLLIN)
        self.feed.data = data
        self.port.poll(0, dict(poll.poll(wait_ms)).get(self.port.number, 0))

    def reader(self) -> int:
        return os.open(self.port.link, os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)


@pytest.fixture
def line(tmp_path: Path) -> Iterator[Line]:
    found = Line(tmp_path / "AXIS_RA")
    yield found
    found.port.close()


def test_a_reader_hears_what_comes_while_it_has_the_port_open(line: Line) -> None:
    line.look(b"before")
    number = line.reader()
    line.look(b"\x00\x0a\xff")  # raw: nothing is translated
    assert read(number, 3) == b"\x00\x0a\xff"
    assert (line.port.heard, line.port.lost, line.port.in_use) == (3, 0, True)
    os.write(number, b"\x03ask\n")
    line.look(wait_ms=5000)
    assert line.taken == [b"\x03ask\n"]
    os.close(number)
    line.look(b"gone")
    assert not line.port.in_use and line.port.heard == 3
    number = line.reader()
    line.look(b"new")
    assert read(number, 3) == b"new"
    os.close(number)


def test_what_the_last_reader_left_is_nobody_s(line: Line) -> None:
    number = line.reader()
    line.look()
    os.write(number, b"left")
    assert select.select([line.port.number], [], [], 5.0)[0]
    os.close(number)
    line.look()
    number = line.reader()
    line.look()
    assert line.taken == []
    os.write(number, b"new")
    line.look(wait_ms=5000)
    assert line.taken == [b"new"]
    os.close(number)


def test_what_a_slow_reader_does_not_take_is_counted(line: Line) -> None:
    number = line.reader()
    line.look(b"x" * 1_000_000)
    assert line.port.lost > 0 and line.port.heard + line.port.lost == 1_000_000
    lost = line.port.lost
    for _ in range(3):
        line.look(b"y" * 100_000)
    assert line.port.lost > lost
    assert line.port.heard + line.port.lost == 1_300_000
    os.close(number)


def test_a_line_without_a_receiver_drops_what_is_sent(tmp_path: Path) -> None:
    source: Any = Source()
    port = PtyPort(tmp_path / "X", source)
    number = os.open(port.link, os.O_RDWR | os.O_NOCTTY)
    port.poll(0, 0)
    os.write(number, b"abc")
    assert select.select([port.number], [], [], 5.0)[0]
    port.poll(0, select.POLLIN)
    with pytest.raises(BlockingIOError):
        os.read(port.number, 1)  # it has been read
    os.close(number)
    port._swallow()
    port.close()
    assert not (tmp_path / "X").is_symlink()
    with pytest.raises(OSError):
        os.fstat(port.number)


def test_a_link_of_an_earlier_run_is_replaced_and_a_file_is_not(tmp_path: Path) -> None:
    link = tmp_path / "X"
    link.symlink_to(tmp_path / "nowhere")
    line = Line(link)
    assert os.readlink(link).startswith("/dev/")
    line.port.link = tmp_path / "another"
    line.port.close()
    assert link.is_symlink()  # somebody else's name is left alone
    file = tmp_path / "Y"
    file.write_text("kept")
    with pytest.raises(OSError, match=r"Y exists and is no symbolic link; another folder\?$"):
        Line(file)
    assert file.read_text() == "kept"


class Live:
    """Two boards' lines; a debug port."""

    def __init__(self) -> None:
        self.dropped: list[tuple[str, Any]] = []
        self.sources: dict[str, Any] = {"A": Source(), "B": Source()}
        self.lines = SimpleNamespace(
            uarts=self.sources, feed=self.sources.__getitem__, drop=lambda *each: self.dropped.append(each)
        )
        self.port = SimpleNamespace(sink=None)
        self.network = SimpleNamespace(debug={"A": self.port})
        self.said: list[tuple[str, bytes]] = []

    def debug(self, board: str, data: bytes) -> None:
        self.said.append((board, data))


def test_a_folder_has_a_port_for_each_board(tmp_path: Path) -> None:
    live: Any = Live()
    door = PtyDoor(str(tmp_path / "a" / "ports"), live)
    assert door.name == f"--serial pty:{tmp_path}/a/ports"
    door.open()
    assert sorted(os.listdir(tmp_path / "a" / "ports")) == ["A", "B"]
    number = os.open(tmp_path / "a" / "ports" / "A", os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    live.sources["A"].data = b"abcd"
    door.poll(0)
    assert read(number, 4) == b"abcd"
    os.close(number)
    door.ports[0].lost = 3
    assert "4 bytes read at A" in door.state() and "3 bytes lost by slow readers" in door.state()
    door.close()
    door.close()
    assert door._poll.poll(0) == []
    assert os.listdir(tmp_path / "a" / "ports") == []
    assert sorted(name for name, _ in live.dropped) == ["A", "B"]
    door.open()
    assert len(door.ports) == 2
    door.close()


def test_a_folder_that_cannot_be_is_said(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    live: Any = Live()
    with pytest.raises(OSError, match=r"^--serial pty: .*file/ports: not a directory$"):
        PtyDoor(str(tmp_path / "file" / "ports"), live).open()
    (tmp_path / "B").write_text("")
    with pytest.raises(OSError, match="B exists and is no symbolic link"):
        PtyDoor(str(tmp_path), live).open()
    assert not (tmp_path / "A").is_symlink() and len(live.dropped) == 2


def test_a_debug_port_speaks_both_ways(tmp_path: Path) -> None:
    live: Any = Live()
    door = DebugDoor(str(tmp_path), live)
    assert door.name == f"--debug {tmp_path}"
    door.open()
    number = os.open(tmp_path / "A", os.O_RDWR | os.O_NOCTTY | os.O_NONBLOCK)
    live.port.sink(0, b"ok\r")
    door.poll(0)
    assert read(number, 3) == b"ok\r"
    os.write(number, b"V\r")
    assert select.select([door.ports[0].number], [], [], 5.0)[0]
    door.poll(0)
    assert live.said == [("A", b"V\r")]
    os.close(number)
    door.close()
    assert live.port.sink is None


def test_of_a_debug_port_4096_bytes_wait() -> None:
    port: Any = SimpleNamespace(sink=None)
    feed = DebugFeed(port)
    feed.hear(0, b"a" * 4096)
    feed.hear(0, b"b")
    assert feed.until(0) == b"a" * 4095 + b"b" and feed.until(0) == b""
    assert serial_pty._KEPT == 4096
