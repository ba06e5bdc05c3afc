"""Rates and efforts as the axis boards take them."""

from bus.units import ARCSEC_PER_TURN

COUNT_ARCSEC = ARCSEC_PER_TURN / (4_608_000 * 24.5)
"""One count of the incremental encoder on the axis, 0.0114796″ (P7: 4.608 M counts, roller 735:30)."""
LOOP_S = 0.005
"""Period of the velocity loop (paper, section 3.3)."""
EFFORT_FULL = 3000
"""Control effort that is 100 % duty."""
CURRENT_A_PER_COUNT = 0.0061
"""Motor current per ADC count (axis log, version 1)."""


def rate_arcsec_s(counts_per_loop: float) -> float:
    """Arcseconds per second from counts per 5 ms."""
    return counts_per_loop * COUNT_ARCSEC / LOOP_S
