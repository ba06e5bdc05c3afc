"""The USB cable: one report per frame, every plug hears every report, limits of both ways."""

from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import usb
from scenarios.doors.usb import DESCRIPTOR, IN_LIMIT, OUT_LIMIT, Usb, UsbFull, out_report
from tests.scenarios.lab.faults.stub import Queue

MS = 1_000_000
REPORT = bytes(range(64))


class Cable:
    """A cable whose gateway may be busy; entries enter at once."""

    def __init__(self) -> None:
        self.queue = Queue()
        self.busy = False
        self.taken: list[tuple[int, bytes]] = []
        self.hid = SimpleNamespace(ready=lambda: not self.busy, write=lambda *each: self.taken.append(each))
        self.kinds: dict[str, Any] = {}
        entry: Any = SimpleNamespace(
            register=self.kinds.__setitem__, enter=lambda kind, data: self.kinds[kind](data)
        )
        queue: Any = self.queue
        hid: Any = self.hid
        self.entry, self.usb = entry, Usb(queue, hid)
        self.usb.enter_by(entry)


@pytest.mark.parametrize(
    ("data", "found"),
    [
        (REPORT, REPORT),
        (b"\0" + REPORT, REPORT),
        (b"\1" + REPORT, None),
        (REPORT[:-1], None),
        (REPORT + b"\0", REPORT[1:] + b"\0"),
        (b"", None),
    ],
)
def test_a_report_has_64_bytes_and_a_leading_0_at_most(data: bytes, found: bytes | None) -> None:
    assert out_report(data) == found


def test_the_descriptor_has_64_bytes_of_8_bits_both_ways() -> None:
    """HID 1.11, 6.2.2: report size 75 08, report count 95 40, input 81 02, output 91 02, end C0."""
    text = DESCRIPTOR.hex()
    assert "7508" in text and text.count("9540") == 2 and text.endswith("91" + "02" + "c0") and "8102" in text
    assert (usb.VENDOR, usb.PRODUCT, usb.VERSION) == (0x04D8, 0x003F, 0x0100)


def test_a_frame_takes_one_report_and_a_busy_gateway_none() -> None:
    cable = Cable()
    plug = cable.usb.plug("a")
    cable.queue.now_ns = 300_000
    for k in range(3):
        plug.write(0, bytes([k]) * 64)
    assert len(cable.queue.due) == 1
    assert cable.queue.step() == 1 * MS and cable.taken == [(1 * MS, bytes(64))]
    cable.busy = True
    assert cable.queue.step() == 2 * MS and len(cable.taken) == 1
    cable.busy = False
    assert [cable.queue.step(), cable.queue.step()] == [3 * MS, 4 * MS]
    assert [data[0] for _, data in cable.taken] == [0, 1, 2] and not cable.queue.due
    plug.write(0, REPORT)
    assert len(cable.queue.due) == 1  # it begins again


def test_of_1024_that_wait_the_next_is_refused() -> None:
    cable = Cable()
    plug = cable.usb.plug("a")
    for _ in range(OUT_LIMIT):
        assert plug.ready
        plug.write(0, REPORT)
    assert not plug.ready and cable.usb.room == 0 and OUT_LIMIT == 1024
    with pytest.raises(UsbFull, match=r"^1024 reports wait for the gateway$"):
        plug.write(0, REPORT)
    cable.queue.step()
    assert plug.ready and cable.usb.room == 1


@pytest.mark.parametrize("size", [63, 65])
def test_another_length_is_refused(size: int) -> None:
    with pytest.raises(ValueError, match=f"^HID report has {size} bytes, the endpoint takes 64$"):
        Cable().usb.plug("a").write(0, bytes(size))


def test_every_plug_hears_every_report_until_it_is_unplugged() -> None:
    cable = Cable()
    one, other = cable.usb.plug("a"), cable.usb.plug("b")
    heard: Any = cable.hid
    heard.to_host(5, REPORT)
    other.unplug()
    other.unplug()
    heard.to_host(6, REPORT)
    assert [t_ns for t_ns, _ in one.reports()] == [5, 6] and one.reports() == []
    assert other.reports() == [(5, REPORT)]


def test_the_oldest_come_first_and_of_too_many_are_gone() -> None:
    cable = Cable()
    plug, heard = cable.usb.plug("a"), cable.hid
    hears: Any = heard
    for t_ns in range(IN_LIMIT + 2):
        hears.to_host(t_ns, REPORT)
    assert [t_ns for t_ns, _ in plug.reports(3)] == [2, 3, 4]
    assert len(plug.reports()) == IN_LIMIT - 3 and IN_LIMIT == 4096


def test_who_was_on_the_cable_before_is_off_it() -> None:
    cable = Cable()
    plug = cable.usb.plug("a")
    cable.usb.enter_by(cable.entry)
    hears: Any = cable.hid
    hears.to_host(5, REPORT)
    assert plug.reports() == []
