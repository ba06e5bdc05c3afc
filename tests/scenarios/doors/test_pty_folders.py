"""Folders of boards' lines and debug ports, and what such a port keeps."""

import os
import select
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import serial_pty
from scenarios.doors.serial_pty import DebugDoor, DebugFeed, PtyDoor
from tests.scenarios.doors.ptyline import Source, read


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
