"""ECAN, the CAN controller inside the PIC18F4480."""

from boards.chips.ecan.chip import Ecan, EcanError

__all__ = ["Ecan", "EcanError"]
