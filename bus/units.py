"""One arcsecond, for the boards, the host and what wires them; the plant has its own (plant/units.py)."""

from math import tau
from typing import Final

ARCSEC_PER_TURN: Final = 1_296_000
ARCSEC_PER_RAD: Final = ARCSEC_PER_TURN / tau
ARCSEC: Final = tau / ARCSEC_PER_TURN
"""rad"""
