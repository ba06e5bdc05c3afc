"""The device's side of USB: control requests of enumeration, and one interrupt endpoint each way."""

from collections import deque
from collections.abc import Callable
from struct import unpack

from boards.chips.usb.descriptors import INTERVAL_MS, REPORT_BYTES, descriptor

GET_DESCRIPTOR, SET_ADDRESS, GET_CONFIGURATION, SET_CONFIGURATION, GET_STATUS = 6, 5, 8, 9, 0
SET_IDLE = 0x0A
_IN_BUFFERS = 2
"""Ping-pong buffers of the endpoint. ASSUMPTION."""
_FRAME_NS = 1_000_000


class Stall(ValueError):
    """The device answers a request with STALL."""


class HidDevice:
    """address, configuration: as enumeration leaves them (0: not yet).

    from_host: called as (t_ns, report) for every output report. Reports go to the host when it polls.
    """

    def __init__(self) -> None:
        self.address = 0
        self.configuration = 0
        self.from_host: Callable[[int, bytes], None] | None = None
        self._in: deque[bytes] = deque()
        self._last_frame = -INTERVAL_MS

    def control(self, setup: bytes) -> bytes:
        """A control transfer by its 8 setup bytes: the data of the answer. Raises Stall for what the device
        does not know."""
        if len(setup) != 8:
            raise Stall(f"a setup packet has 8 bytes, this one {len(setup)}")
        kind, request, value, _, length = unpack("<BBHHH", setup)
        if request == GET_DESCRIPTOR and kind in (0x80, 0x81):
            found = descriptor(value >> 8, value & 0xFF)
            if found is not None:
                return found[:length]
        elif (kind, request) == (0x00, SET_ADDRESS) and value < 128:
            self.address = value
            return b""
        elif (kind, request) == (0x00, SET_CONFIGURATION) and value in (0, 1):
            self.configuration = value
            return b""
        elif (kind, request) == (0x80, GET_CONFIGURATION):
            return bytes((self.configuration,))
        elif (kind, request) == (0x80, GET_STATUS):
            return bytes(2)
        elif (kind, request) == (0x21, SET_IDLE):
            return b""
        raise Stall(f"request {kind:#04x} {request:#04x} value {value:#06x} is not known")

    def put(self, report: bytes) -> bool:
        """Firmware hands over an input report; False: both buffers are full. Raises ValueError unless it has
        64 bytes."""
        if len(report) != REPORT_BYTES:
            raise ValueError(f"a report has {REPORT_BYTES} bytes, this one {len(report)}")
        if len(self._in) >= _IN_BUFFERS:
            return False
        self._in.append(report)
        return True

    def poll(self, t_ns: int) -> bytes | None:
        """The host's IN token at `t_ns`: a report, or None (NAK): nothing there, not configured, or polled
        within the interval."""
        frame = t_ns // _FRAME_NS
        if not self.configuration or not self._in or frame - self._last_frame < INTERVAL_MS:
            return None
        self._last_frame = frame
        return self._in.popleft()

    def out(self, t_ns: int, report: bytes) -> None:
        """The host's OUT transaction. Raises Stall when not configured, or for a wrong length."""
        if not self.configuration:
            raise Stall("the device is not configured")
        if len(report) != REPORT_BYTES:
            raise Stall(f"the endpoint takes {REPORT_BYTES} bytes, not {len(report)}")
        if self.from_host is not None:
            self.from_host(t_ns, report)
