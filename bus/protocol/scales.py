"""What counts, steps and rates of an axis are in arcseconds."""

from typing import Final

from bus.units import ARCSEC_PER_TURN

COUNTS_PER_TURN: Final = 112_896_000
"""Incremental encoder: 4.608e6 counts x 735/30 (paper, sections 2.2 and 3.2; hardware.md 2.1)."""
STEPS_PER_TURN: Final = 1 << 29
"""Absolute encoder RCN 829 (paper, section 3.2)."""
TICKS_PER_S: Final = 200
"""Of the controller, 5 ms (paper, section 3.3)."""


def rate_q16(arcsec_per_s: float) -> int:
    """A rate in arcsec/s as counts per 5 ms in Q16: 15 becomes 6.53333."""
    return round(arcsec_per_s * COUNTS_PER_TURN / ARCSEC_PER_TURN / TICKS_PER_S * 65536)
