"""The gateway as a USB HID device: identity, report descriptor, and the 65-byte trap.

64-byte reports without report numbers, in and out, on a vendor-defined page.
"""

VENDOR, PRODUCT, VERSION = 0x04D8, 0x003F, 0x0100
"""ASSUMPTION: the paper gives none. Microchip's vendor id and the product id of its HID example, which
a PIC18F4550 without an id of its own would carry."""
NAME = "Schmidt telescope gateway"
BYTES = 64
DESCRIPTOR = bytes.fromhex(
    "0600ff 0901 a101"  # usage page (vendor), usage, collection (application)
    "1500 26ff00 7508 9540"  # logical 0..255, 8 bits, 64 of them
    "0901 8102"  # input
    "9540 0901 9102"  # output
    "c0"
)


def out_report(data: bytes) -> bytes | None:
    """The 64 bytes of an OUT report as a program wrote them, or None when it is none.

    A program that writes to hidraw puts report number 0 in front. Uhid passes on all 65 bytes where usbhid
    strips the first (drivers/hid/uhid.c, hardware.md 3.6).
    """
    if len(data) == BYTES + 1 and data[0] == 0:
        return data[1:]
    return data if len(data) == BYTES else None
