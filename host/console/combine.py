"""Statistical combination of the encoders of one axis (H5)."""

from __future__ import annotations

import math
from typing import NamedTuple

from host.sky.mount import STEP_ARCSEC

ABSOLUTE_ARCSEC = 1.0 / math.sqrt(3.0)
"""Standard deviation of the on-shaft encoder: an error within ±1″ (RCN 800's system accuracy, hardware.md
1.3), taken as uniform."""
AUXILIARY_ARCSEC = math.hypot(15.0 / 10.8 / math.sqrt(3.0), 1296000 / 2**17 / 10.8 / math.sqrt(12.0))
"""Of the auxiliary one: ±15″ through 1:10.8 (paper, section 3.2), uniform, and its step of 0.9155″."""


class Combined(NamedTuple):
    """Readings of one axis in ″ from the encoder's zero, and the estimate with its standard deviation."""

    absolute_arcsec: float | None
    auxiliary_arcsec: float | None
    difference_arcsec: float | None
    estimate_arcsec: float | None
    sigma_arcsec: float


def combine(absolute_steps: int | None, auxiliary_arcsec: float | None) -> Combined:
    """Mean weighted by inverse variances; its variance is the inverse of their sum."""
    absolute = None if absolute_steps is None else absolute_steps * STEP_ARCSEC
    if absolute is None and auxiliary_arcsec is None:
        return Combined(None, None, None, None, math.inf)
    if absolute is None:
        return Combined(None, auxiliary_arcsec, None, auxiliary_arcsec, AUXILIARY_ARCSEC)
    if auxiliary_arcsec is None:
        return Combined(absolute, None, None, absolute, ABSOLUTE_ARCSEC)
    weights = (ABSOLUTE_ARCSEC**-2, AUXILIARY_ARCSEC**-2)
    estimate = (weights[0] * absolute + weights[1] * auxiliary_arcsec) / sum(weights)
    difference = absolute - auxiliary_arcsec
    return Combined(absolute, auxiliary_arcsec, difference, estimate, sum(weights) ** -0.5)
