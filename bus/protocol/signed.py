"""Sign bits of the odd-sized signals: `(value ^ SIGN) - SIGN` extends the sign."""

SIGN_13 = 1 << 12
SIGN_15 = 1 << 14
