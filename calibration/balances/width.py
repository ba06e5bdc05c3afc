"""How wide the low pass is that every column of a balance goes through: from noise, from declared waves."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d

from calibration.arrays import Array
from calibration.balances.filters import pieces
from calibration.inputs.declaration import Rig

MOST = 40.0  # rows: standard deviation of the filter at most. ASSUMPTION
FEW = 600  # rows behind the filter, that are few: half of them stands still or is held out. ASSUMPTION
LEAST_OF_SENSORS = 4.0  # rows likewise at least, where the balance holds no acceleration. ASSUMPTION
NYQUIST = 0.5  # cycles per row. by arithmetic
WIDER = 1.25  # times as wide, the next filter that is tried. ASSUMPTION


class Limits(NamedTuple):
    """noise: of the acceleration's rms, that the position's noise may leave in it. least: rows, standard
    deviation of the filter at least, where the rig file does not say it."""

    noise: float
    least: float


USUAL = Limits(noise=0.01, least=2.0)  # ASSUMPTION
# where a filter leaves few rows, or what it hides is looked for: an inertia is then off by the square of it,
# a thousandth, and a row is half the reach of a second difference. ASSUMPTION
NARROW = Limits(noise=0.03, least=1.0)


def told_by_noise(x: Array, file: NDArray[np.int64], noise: float, limits: Limits = USUAL) -> float:
    """Rows: wide enough for the position's `noise` to be a small part of the acceleration."""
    sigma = limits.least
    while sigma < MOST:
        a = np.concatenate([np.diff(gaussian_filter1d(x[i:j], sigma), 2) for i, j in pieces(file)])
        size = float(np.sqrt(np.mean(np.clip(a, *np.quantile(a, [0.005, 0.995])) ** 2)))
        most = limits.noise if len(x) > FEW * sigma else NARROW.noise
        if noise * np.sqrt(3 / (8 * np.sqrt(np.pi)) / sigma**5) < most * size:
            break
        sigma *= WIDER
    return sigma


def passing_waves(x: Array, file: NDArray[np.int64], rig: Rig, sigma: float, least: float) -> float:
    """Rows: the filter that leaves the quickest declared wave 0.6 of its amplitude at the usual top speed.

    It is `least` at least, as quicker accelerations than the position tells are in the response, too.
    """
    soft = np.concatenate(
        [np.gradient(gaussian_filter1d(x[i:j], sigma)) for i, j in pieces(file) if j > i + 1]
    )
    waves = max((g.harmonics / g.period for g in rig.stages if g.period), default=0.0)
    cycles = min(float(np.quantile(np.abs(soft), 0.95)) * waves, NYQUIST)
    return max(1 / (2 * np.pi * cycles), least) if cycles > 0 else np.inf
