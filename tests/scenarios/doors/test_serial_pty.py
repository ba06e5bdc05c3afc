"""A line as a pseudo-terminal: its name, readers that come and go, slow ones."""

import os
import select
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from scenarios.doors.serial_pty import PtyPort
from tests.scenarios.doors.ptyline import Line, Source, read


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
