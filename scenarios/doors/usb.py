"""The gateway as a USB HID device: identity, report descriptor, cable, and the programs that share it.

    usb = Usb(queue, network.hid)
    usb.enter_by(entry)
    plug = usb.plug("alpaca")
    link = HidLink(plug.write)                      # host/link.py. The client sends through it
    for t_ns, report in plug.reports():             # in the door's poll: what the gateway has sent since
        link.receive(t_ns, report)

Every plug hears every report; commands of all plugs go out one after the other, one report per USB frame.
"""

from __future__ import annotations

from collections import deque
from typing import TYPE_CHECKING

from boards.silicon.hid import FRAME_NS, REPORT_BYTES, HidEndpoint, next_frame_ns
from bus.time import EventQueue

if TYPE_CHECKING:
    from scenarios.doors.livenetwork import Entry

VENDOR, PRODUCT, VERSION = 0x04D8, 0x003F, 0x0100
"""ASSUMPTION: the paper gives none. Microchip's vendor id and the product id of its HID example, which
a PIC18F4550 without an id of its own would carry."""
NAME = "Schmidt telescope gateway"
DESCRIPTOR = bytes.fromhex(
    "0600ff 0901 a101"  # usage page (vendor), usage, collection (application)
    "1500 26ff00 7508 9540"  # logical 0..255, 8 bits, 64 of them
    "0901 8102"  # input
    "9540 0901 9102"  # output
    "c0"
)
"""64-byte reports without report numbers, in and out, on a vendor-defined page."""


def out_report(data: bytes) -> bytes | None:
    """The 64 bytes of an OUT report as a program wrote them, or None when it is none.

    A program that writes to hidraw puts report number 0 in front. Uhid passes on all 65 bytes where usbhid
    strips the first (drivers/hid/uhid.c, hardware.md 3.6).
    """
    if len(data) == REPORT_BYTES + 1 and data[0] == 0:
        return data[1:]
    return data if len(data) == REPORT_BYTES else None


KIND = "usb"
OUT_LIMIT = 1024
"""OUT reports that wait for the gateway; a driver's write blocks or fails beyond. ASSUMPTION."""
IN_LIMIT = 4096
"""IN reports kept for a host program that does not read. Linux' hidraw keeps 64; a program in this process
may be busy for a second. ASSUMPTION."""


class UsbFull(OSError):
    """The gateway takes reports more slowly than they come: try again later, or lose it."""


class UsbPlug:
    """One host program's end; of what it does not read in time the oldest is gone."""

    def __init__(self, usb: Usb, name: str) -> None:
        self.name = name
        self._usb = usb
        self._reports: deque[tuple[int, bytes]] = deque(maxlen=IN_LIMIT)

    def write(self, t_ns: int, report: bytes) -> None:
        """Send an OUT report of 64 bytes, now (`t_ns` is there for `HidLink`).

        Raises ValueError for another length, `UsbFull` when too many wait.
        """
        if len(report) != REPORT_BYTES:
            raise ValueError(f"HID report has {len(report)} bytes, the endpoint takes {REPORT_BYTES}")
        self._usb.write(report)

    @property
    def ready(self) -> bool:
        """Whether the next `write` will be taken."""
        return self._usb.room > 0

    def reports(self, most: int = IN_LIMIT) -> list[tuple[int, bytes]]:
        """(t_ns, 64 bytes) of every IN report since the last call, the oldest `most` of them."""
        return [self._reports.popleft() for _ in range(min(most, len(self._reports)))]

    def hear(self, t_ns: int, report: bytes) -> None:
        """The gateway has sent a report; called by `Usb`."""
        self._reports.append((t_ns, report))

    def unplug(self) -> None:
        """Hear no more."""
        self._usb.unplug(self)


class Usb:
    """The cable: fans out IN reports to all plugs, polls OUT reports into the gateway once a USB frame."""

    def __init__(self, queue: EventQueue, hid: HidEndpoint) -> None:
        self._queue = queue
        self._hid = hid
        self._plugs: list[UsbPlug] = []
        self._out: deque[bytes] = deque()
        self._polling = False

    def enter_by(self, entry: Entry) -> None:
        """What host programs write enters here from now on; those that were on the cable are off it."""
        self._entry = entry
        self._plugs.clear()
        self._hid.to_host = self._heard
        entry.register(KIND, self._take)

    def plug(self, name: str) -> UsbPlug:
        """A new host program on the cable."""
        plug = UsbPlug(self, name)
        self._plugs.append(plug)
        return plug

    def unplug(self, plug: UsbPlug) -> None:
        """Forget a program; twice does nothing."""
        if plug in self._plugs:
            self._plugs.remove(plug)

    @property
    def room(self) -> int:
        """OUT reports that may still be written."""
        return OUT_LIMIT - len(self._out)

    def write(self, report: bytes) -> None:
        """An OUT report enters."""
        if not self.room:
            raise UsbFull(f"{OUT_LIMIT} reports wait for the gateway")
        self._entry.enter(KIND, report)

    def _take(self, report: bytes) -> None:
        self._out.append(report)
        if not self._polling:
            self._polling = True
            self._queue.at(next_frame_ns(self._queue.now_ns), self._frame)

    def _frame(self, t_ns: int) -> None:
        """Start of a USB frame: the host controller offers one report, the gateway takes it or NAKs."""
        if self._hid.ready():
            self._hid.write(t_ns, self._out.popleft())
        self._polling = bool(self._out)
        if self._out:
            self._queue.at(t_ns + FRAME_NS, self._frame)

    def _heard(self, t_ns: int, report: bytes) -> None:
        for plug in self._plugs:
            plug.hear(t_ns, report)
