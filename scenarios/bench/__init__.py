"""`make bench`: how fast the emulator is, measured on this machine, beside python-can's own virtual bus."""
