"""EnDat position reader (B3): PIC18F4480 with on-chip CAN, one per axis."""
