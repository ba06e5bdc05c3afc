"""Descriptors of the gateway as USB 2.0 (chapter 9) and HID 1.11 (section 6) lay them out."""

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
        VENDOR & 0xFF, VENDOR >> 8, PRODUCT & 0xFF, PRODUCT >> 8, 0x00, 0x01, 1, 2, 0, 1,
    )
)  # fmt: skip

HID = bytes((9, HID_TYPE, 0x11, 0x01, 0, 1, REPORT_TYPE, len(REPORT) & 0xFF, len(REPORT) >> 8))


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
