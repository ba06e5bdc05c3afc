"""EnDat 2.1/2.2, both ends: whole frames as integers (`fast.py`), and clock by clock (`encoder.py`)."""

from boards.silicon.endat.crc import crc5
from boards.silicon.endat.encoder import ClockedEncoder
from boards.silicon.endat.fast import (
    CALCULATION_NS,
    CLOCK_HZ,
    COMMAND_CLOCKS,
    POSITION_BITS,
    RECOVERY_NS,
    EndatEncoder,
    EndatMaster,
    Reading,
    check,
    position_crc,
)
from boards.silicon.endat.master import ClockedMaster, EndatError

__all__ = [
    "CALCULATION_NS", "CLOCK_HZ", "COMMAND_CLOCKS", "POSITION_BITS", "RECOVERY_NS", "ClockedEncoder",
    "ClockedMaster", "EndatEncoder", "EndatError", "EndatMaster", "Reading", "check", "crc5", "position_crc",
]  # fmt: skip
