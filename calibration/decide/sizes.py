"""Sizes that a decision compares: of a found sine, of the noise on the analysis grid."""

from __future__ import annotations

import numpy as np

from calibration.channels.problem import Problem
from calibration.decide.select import Selection
from calibration.readers.run import Array


def largest_amplitude(s: Selection) -> float:
    """Largest sine amplitude of the first chosen effect."""
    at = s.problem.base.shape[1]
    beta = s.after.beta[at : at + s.chosen[0].candidate.width]
    return (
        float(np.sqrt(beta[0::2] ** 2 + beta[1::2] ** 2).max())
        if len(beta) % 2 == 0
        else float(np.abs(beta).max())
    )


def white_noise(e: Array, p: Problem) -> float:
    """rms of the sample-to-sample noise of the analysis grid (means over the same two boxcars)."""
    x = np.where(p.train, e, np.nan)
    second = x[2:] - 2 * x[1:-1] + x[:-2]
    return float(np.sqrt(np.nanmean(second**2) / (6 - 32 / 19)))


def quiet_noise(e: Array, p: Problem) -> float:
    """As `white_noise`, from the median: bursts do not count."""
    x = np.where(p.train, e, np.nan)
    second = x[2:] - 2 * x[1:-1] + x[:-2]
    return float(1.4826 * np.nanmedian(np.abs(second)) / np.sqrt(6 - 32 / 19))
