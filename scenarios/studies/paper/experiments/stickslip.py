"""Stick phases and the leaps between them, from logged counts."""

import numpy as np

from scenarios.studies.paper.log import Log
from scenarios.studies.paper.scales import COUNT_RATE, LOG_PERIOD_S

STICK_S = 0.1
"""s: shorter standstills are not called a stick phase. ASSUMPTION."""
STILL = COUNT_RATE / 2.0
"""arcsec/s: half the velocity quantum; a slower axis reads zero more often than not."""


def stick_slips(log: Log, setpoint: float, leap: float) -> int:
    """Return how often a stick phase (mean of 0.1 s within half a count of zero) was followed by a velocity
    above `leap` set points."""
    width = round(STICK_S / LOG_PERIOD_S)
    mean = np.convolve(log.rate, np.full(width, 1.0 / width), mode="valid")
    still = np.concatenate([np.abs(mean) < STILL, np.zeros(width - 1, dtype=bool)])
    fast = log.rate > leap * setpoint
    count, stuck = 0, False
    for at_rest, leaps in zip(still, fast, strict=True):
        if leaps:
            count += stuck
            stuck = False
        elif at_rest:
            stuck = True
    return count
