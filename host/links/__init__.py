"""The PC's cables: HID, CAN and serial ports, each read by a task of its own."""
