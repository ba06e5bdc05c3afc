"""EnDat position reader (B3): PIC18F4480 with on-chip CAN, one per axis."""

from boards.position.firmware import PositionBoard
from boards.position.pins import PositionPins

__all__ = ["PositionBoard", "PositionPins"]
