"""Sign bits of the odd-sized signals: `(value ^ SIGN) - SIGN` extends the sign."""

from typing import Final

SIGN_13: Final = 1 << 12
SIGN_15: Final = 1 << 14
