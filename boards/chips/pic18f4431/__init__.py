"""QEI of the PIC18F4431 at register level (DS39616D)."""

from boards.chips.pic18f4431.qei import Qei4431

__all__ = ["Qei4431"]
