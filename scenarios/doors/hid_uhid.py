"""`--hid uhid`: the gateway as a real /dev/hidrawN, made by Linux' uhid (include/uapi/linux/uhid.h)."""

import os
from struct import Struct

from scenarios.doors.door import counted
from scenarios.doors.livenetwork import LiveNetwork
from scenarios.doors.usb import DESCRIPTOR, NAME, PRODUCT, VENDOR, VERSION, UsbPlug, out_report

DEVICE = "/dev/uhid"
_DESTROY, _CREATE2, _INPUT2 = 1, 11, 12
_OPEN, _CLOSE, _OUTPUT = 4, 5, 6
_GET_REPORT, _GET_REPLY, _SET_REPORT, _SET_REPLY = 9, 10, 13, 14
_BUS_USB = 3
_DATA = 4096
_EVENT_BYTES = 4 + 128 + 64 + 64 + 2 + 2 + 4 * 4 + _DATA
_create2 = Struct(f"<I128s64s64sHHIIII{_DATA}s")
_input2 = Struct("<IH")
_output = Struct(f"<I{_DATA}sHB")
_request = Struct("<IIBB")
_set_request = Struct(f"<IIBBH{_DATA}s")
_get_reply = Struct("<IIHH")
_set_reply = Struct("<IIH")
_EIO = 5
_EVENTS = 32  # The kernel's own queue of events.


class UhidDoor:
    """One device. opened: whether a program has it open, as the kernel says; came: how often."""

    def __init__(self, served: LiveNetwork, device: str = DEVICE) -> None:
        self.name = "--hid uhid"
        self._served = served
        self._device = device
        self._file: int | None = None
        self._plug: UsbPlug | None = None
        self.opened = False
        self.came = 0
        self.rejected = 0

    def open(self) -> None:
        """Create the device; raises OSError."""
        try:
            self._file = os.open(self._device, os.O_RDWR | os.O_NONBLOCK | os.O_CLOEXEC)
            os.write(self._file, create_event())
        except OSError as error:
            self.close()
            hint = "; --hid unix:PATH works without it" if isinstance(error, FileNotFoundError) else ""
            raise OSError(f"--hid uhid: {self._device}: {error.strerror}{hint}") from None
        self._plug = self._served.usb.plug(self.name)

    def poll(self, _now_ns: int) -> None:
        """Events of the kernel, then the reports of the gateway."""
        if self._file is None or self._plug is None:
            return
        for _ in range(_EVENTS):
            if not self._plug.ready:
                break
            try:
                event = os.read(self._file, _EVENT_BYTES)
            except BlockingIOError:
                break
            self._take(event)
        for _, report in self._plug.reports():
            if self.opened:
                self._write(_input2.pack(_INPUT2, len(report)) + report)

    def _take(self, event: bytes) -> None:
        kind = int.from_bytes(event[:4], "little")
        event = event.ljust(_EVENT_BYTES, b"\0")
        if kind == _OPEN:
            self.opened = True
            self.came += 1
        elif kind == _CLOSE:
            self.opened = False
        elif kind == _OUTPUT:
            _, data, size, _ = _output.unpack_from(event)
            self._report(data[:size])
        elif kind == _GET_REPORT:
            _, number, _, _ = _request.unpack_from(event)
            self._write(_get_reply.pack(_GET_REPLY, number, _EIO, 0))  # the gateway has no feature reports
        elif kind == _SET_REPORT:
            _, number, _, _, size, data = _set_request.unpack_from(event)
            self._report(data[:size])
            self._write(_set_reply.pack(_SET_REPLY, number, 0))

    def _report(self, data: bytes) -> None:
        report = out_report(data)
        if report is None or self._plug is None:
            self.rejected += 1
            return
        self._plug.write(self._served.now_ns, report)  # there is room: `poll` has looked

    def _write(self, event: bytes) -> None:
        if self._file is not None:
            os.write(self._file, event)

    def close(self) -> None:
        """Take the device away."""
        if self._plug is not None:
            self._plug.unplug()
        if self._file is not None:
            os.close(self._file)  # the kernel destroys the device
        self._file = self._plug = None
        self.opened = False

    def state(self) -> str:
        """How often it was opened, and what did not pass."""
        return counted((self.came, "times opened"), (self.rejected, "were no reports"))


def create_event() -> bytes:
    """UHID_CREATE2 with the gateway's identity and report descriptor."""
    return _create2.pack(
        _CREATE2, NAME.encode(), b"schmidt", b"1", len(DESCRIPTOR), _BUS_USB, VENDOR, PRODUCT, VERSION, 0,
        DESCRIPTOR,
    )  # fmt: skip
