"""USB full-speed HID device of the PIC18F4550: descriptors as tables, endpoints and control requests."""

from boards.chips.usb.device import HidDevice, Stall

__all__ = ["HidDevice", "Stall"]
