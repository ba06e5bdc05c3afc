"""ECAN, the CAN controller inside the PIC18F4480."""

from boards.silicon.ecan.chip import Ecan, EcanError

__all__ = ["Ecan", "EcanError"]
