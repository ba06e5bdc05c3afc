"""The gateway as a uhid device: bytes of the kernel's own structures (include/uapi/linux/uhid.h)."""

import os
import struct
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import hid_uhid
from scenarios.doors.hid_uhid import UhidDoor, create_event

KEPT = ("open", "close", "O_RDWR", "O_NONBLOCK", "O_CLOEXEC")
REPORT = bytes(range(64))
OPEN, CLOSE, OUTPUT, GET, SET = 4, 5, 6, 9, 13
EVENT_BYTES = 4 + 4372
"""A type of 32 bits, and the largest request, UHID_CREATE2."""


class Plug:
    """The cable's end: takes so many reports, has some to give."""

    def __init__(self) -> None:
        self.room = 1000
        self.written: list[tuple[int, bytes]] = []
        self.waiting: list[tuple[int, bytes]] = []
        self.plugged = True

    @property
    def ready(self) -> bool:
        return len(self.written) < self.room

    def write(self, t_ns: int, report: bytes) -> None:
        self.written.append((t_ns, report))

    def reports(self) -> list[tuple[int, bytes]]:
        found, self.waiting = self.waiting, []
        return found

    def unplug(self) -> None:
        self.plugged = False


class Kernel:
    """What the door reads and writes."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
        self.events: list[bytes] = []
        self.written: list[bytes] = []
        self.asked: list[int] = []
        device = tmp_path / "uhid"
        device.touch()
        self.plug = Plug()
        served: Any = SimpleNamespace(usb=SimpleNamespace(plug=lambda name: self.plug), now_ns=77)
        self.door = UhidDoor(served, str(device))
        fake = SimpleNamespace(
            **{name: getattr(os, name) for name in ("open", "close", "O_RDWR", "O_NONBLOCK", "O_CLOEXEC")}
        )
        fake.read, fake.write = self.read, lambda number, data: self.written.append(data)
        monkeypatch.setattr(hid_uhid, "os", fake)

    def read(self, _number: int, size: int) -> bytes:
        self.asked.append(size)
        if not self.events:
            raise BlockingIOError
        return self.events.pop(0)

    def say(self, *events: bytes) -> None:
        self.events += events
        self.door.poll(0)


def event(kind: int, form: str = "", *values: Any) -> bytes:
    return struct.pack("<I" + form, kind, *values)


@pytest.fixture
def kernel(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Any:
    found = Kernel(monkeypatch, tmp_path)
    found.door.open()
    yield found
    found.door.close()


def test_the_device_is_created_with_the_gateway_s_identity(kernel: Kernel) -> None:
    """name[128], phys[64], uniq[64], rd_size, bus, vendor, product, version, country, rd_data[4096]."""
    (made,) = kernel.written
    fields = struct.unpack("<I128s64s64sHHIIII4096s", made)
    assert len(made) == EVENT_BYTES and made == create_event()
    assert fields[0] == 11 and fields[1].rstrip(b"\0") == b"Schmidt telescope gateway"
    assert fields[2].rstrip(b"\0") == b"schmidt" and fields[3].rstrip(b"\0") == b"1"
    assert fields[5:10] == (3, 0x04D8, 0x003F, 0x0100, 0)  # BUS_USB
    assert fields[10][: fields[4]].hex().startswith("0600ff") and fields[10][fields[4] :].strip(b"\0") == b""


def test_reports_of_the_gateway_go_to_who_has_it_open(kernel: Kernel) -> None:
    kernel.written.clear()
    kernel.plug.waiting = [(1, REPORT)]
    kernel.door.poll(0)
    assert kernel.written == []
    kernel.plug.waiting = [(1, REPORT), (2, REPORT[::-1])]
    kernel.say(event(OPEN))
    assert kernel.door.opened and kernel.door.came == 1
    assert kernel.written == [struct.pack("<IH", 12, 64) + each for each in (REPORT, REPORT[::-1])]
    kernel.plug.waiting = [(1, REPORT)]
    kernel.say(event(CLOSE))
    assert not kernel.door.opened and len(kernel.written) == 2
    kernel.say(event(OPEN))
    assert kernel.door.state() == "2 times opened"


@pytest.mark.parametrize("data", [REPORT, b"\0" + REPORT])
def test_an_output_event_is_a_report_with_or_without_its_number(kernel: Kernel, data: bytes) -> None:
    kernel.say(event(OUTPUT, "4096sHB", data, len(data), 1))
    assert kernel.plug.written == [(77, REPORT)] and kernel.door.rejected == 0
    assert set(kernel.asked) == {EVENT_BYTES}


def test_what_is_no_report_is_counted(kernel: Kernel) -> None:
    kernel.say(event(OUTPUT, "4096sHB", REPORT, 63, 1), event(OUTPUT))
    assert kernel.plug.written == [] and kernel.door.rejected == 2
    assert "2 were no reports" in kernel.door.state()


def test_a_request_for_a_feature_is_refused_with_EIO(kernel: Kernel) -> None:
    kernel.written.clear()
    kernel.say(event(GET, "IBB", 41, 0, 0))
    assert kernel.written == [struct.pack("<IIHH", 10, 41, 5, 0)]


def test_a_report_that_is_set_is_taken_and_answered(kernel: Kernel) -> None:
    kernel.written.clear()
    kernel.say(event(SET, "IBBH4096s", 42, 0, 1, 64, REPORT))
    assert kernel.written == [struct.pack("<IIH", 14, 42, 0)] and kernel.plug.written == [(77, REPORT)]


def test_another_event_means_nothing(kernel: Kernel) -> None:
    kernel.written.clear()
    kernel.say(event(2), event(3))
    assert not kernel.written and not kernel.door.opened and kernel.door.came == 0


def test_32_events_are_read_in_a_look_and_none_while_the_gateway_is_busy(kernel: Kernel) -> None:
    kernel.say(*[event(OPEN)] * 40)
    assert kernel.door.came == 32
    kernel.plug.room = 0
    kernel.door.poll(0)
    assert kernel.door.came == 32
    kernel.plug.room = 1
    kernel.events.insert(0, event(OUTPUT, "4096sHB", REPORT, 64, 1))
    kernel.door.poll(0)
    assert kernel.door.came == 32 and len(kernel.plug.written) == 1


def test_closed_it_is_unplugged_and_does_nothing(kernel: Kernel) -> None:
    kernel.say(event(OPEN))
    kernel.door.close()
    assert not kernel.plug.plugged and not kernel.door.opened
    kernel.say(event(OPEN))
    assert kernel.door.came == 1
    kernel.door._write(b"x")
    kernel.door._report(REPORT)
    assert kernel.door.rejected == 1 and kernel.plug.written == []
    kernel.door.close()


def test_a_kernel_without_uhid_is_said_with_the_way_around(tmp_path: Path) -> None:
    served: Any = SimpleNamespace()
    with pytest.raises(OSError) as caught:
        UhidDoor(served, str(tmp_path / "none")).open()
    text = f"--hid uhid: {tmp_path / 'none'}: No such file or directory; --hid unix:PATH works without it"
    assert str(caught.value) == text
    with pytest.raises(OSError, match=r": Is a directory$"):
        UhidDoor(served, str(tmp_path)).open()
    assert UhidDoor(served).name == "--hid uhid" and hid_uhid.DEVICE == "/dev/uhid"
