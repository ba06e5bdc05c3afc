"""The doors of `schmidt serve`: what they have in common, and one file each."""

from scenarios.doors.door import Door, DoorError
from scenarios.doors.entry import Entry, EntryError
from scenarios.doors.keeper import Keeper
from scenarios.doors.served import Served
from scenarios.doors.usb import Usb, UsbFull, UsbPlug

__all__ = ["Door", "DoorError", "Entry", "EntryError", "Keeper", "Served", "Usb", "UsbFull", "UsbPlug"]
