"""EnDat 2.1/2.2 clock by clock: the encoder and a master. `boards.silicon.endat` has whole frames."""

from boards.chips.endat.encoder import ClockedEncoder
from boards.chips.endat.master import ClockedMaster, EndatError

__all__ = ["ClockedEncoder", "ClockedMaster", "EndatError"]
