"""The declared friction along a measured motion: LuGre with the exact bristle update (paper, equations
3-5)."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.readers.run import Array
from calibration.statistics.whitening import Mask
from plant.compiled import entry


@entry
def _bristle(
    theta: Array,
    fresh: Any,
    dt: float,
    ratio: float,
    vs: float,
    stiffness: float,
    exponent: float,
) -> Array:
    """Bristle torque over Coulomb torque, sigma_0 z / Tc, along the motion theta (n,), for g = 1 +
    (ratio-1) e^-(w/vs)^exponent.

    `stiffness` is sigma_0 / Tc in 1/rad. The update is exact for a constant rate within the step, and the
    increments
    of theta are used as they are, so that pre-sliding displacements do not drift.
    """
    out = np.zeros(len(theta))
    z = 0.0
    for k in range(1, len(theta)):
        if fresh[k]:
            z = 0.0
            continue
        move = theta[k] - theta[k - 1]
        w = abs(move) / dt
        g = 1.0 + (ratio - 1.0) * np.exp(-((w / vs) ** exponent))
        end = g if move > 0 else -g
        a = stiffness * abs(move) / g
        z = end + (z - end) * np.exp(-a)
        out[k] = z
    return out


def bristle(
    theta: Array,
    fresh: Mask,
    dt: float,
    ratio: float,
    vs: float,
    stiffness: float,
    exponent: float = 2.0,
) -> Array:
    """See `_bristle`."""
    return np.asarray(_bristle(theta, fresh, dt, ratio, vs, stiffness, exponent))
