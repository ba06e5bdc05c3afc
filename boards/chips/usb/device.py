"""The device's side of USB: descriptors, control requests of enumeration, one interrupt endpoint each way.

Descriptors are as USB 2.0 (chapter 9) and HID 1.11 (section 6) lay them out.
"""

from collections import deque
from collections.abc import Callable
from struct import unpack

REPORT_BYTES = 64
INTERVAL_MS = 1
IN_ENDPOINT, OUT_ENDPOINT = 0x81, 0x01
VENDOR, PRODUCT = 0x04D8, 0x003F
"""Microchip's vendor number and its generic HID demonstration. ASSUMPTION: the paper gives none."""
DEVICE_TYPE, CONFIGURATION_TYPE, STRING_TYPE, HID_TYPE, REPORT_TYPE = 0x01, 0x02, 0x03, 0x21, 0x22

REPORT = bytes(
    (
        0x06, 0x00, 0xFF,  # usage page: vendor defined
        0x09, 0x01,  # usage 1
        0xA1, 0x01,  # collection: application
        0x15, 0x00, 0x26, 0xFF, 0x00,  # logical 0..255
        0x75, 0x08, 0x95, REPORT_BYTES,  # 64 fields of 8 bits
        0x09, 0x01, 0x81, 0x02,  # input: data, variable, absolute
        0x09, 0x01, 0x91, 0x02,  # output: the same
        0xC0,  # end of collection
    )
)  # fmt: skip

DEVICE = bytes(
    (
        18, DEVICE_TYPE, 0x00, 0x02,  # USB 2.0
        0, 0, 0, 8,  # class by interface, endpoint 0 of 8 bytes
        *VENDOR.to_bytes(2, "little"), *PRODUCT.to_bytes(2, "little"), 0x00, 0x01, 1, 2, 0, 1,
    )
)  # fmt: skip

HID = bytes((9, HID_TYPE, 0x11, 0x01, 0, 1, REPORT_TYPE, *len(REPORT).to_bytes(2, "little")))


def _endpoint(address: int) -> bytes:
    return bytes((7, 5, address, 0x03, REPORT_BYTES, 0, INTERVAL_MS))  # interrupt


_BODY = bytes((9, 4, 0, 0, 2, 3, 0, 0, 0)) + HID + _endpoint(IN_ENDPOINT) + _endpoint(OUT_ENDPOINT)
CONFIGURATION = bytes((9, CONFIGURATION_TYPE, 9 + len(_BODY), 0, 1, 1, 0, 0x80, 50)) + _BODY
"""One configuration, powered by the bus, 100 mA."""
STRINGS = (b"\x09\x04", "ARIES".encode("utf-16-le"), "Schmidt gateway".encode("utf-16-le"))


def descriptor(kind: int, index: int) -> bytes | None:
    """The descriptor a host asks for; None: there is none."""
    if kind == STRING_TYPE:
        if index >= len(STRINGS):
            return None
        return bytes((2 + len(STRINGS[index]), STRING_TYPE)) + STRINGS[index]
    if index:
        return None
    return {DEVICE_TYPE: DEVICE, CONFIGURATION_TYPE: CONFIGURATION, HID_TYPE: HID, REPORT_TYPE: REPORT}.get(
        kind
    )


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
        """A control transfer by its 8 setup bytes: the answer's data. Raises Stall for what is not known."""
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
