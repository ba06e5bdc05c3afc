"""Stretches of rows, and the low pass that every column of a balance goes through."""

import itertools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter1d, uniform_filter1d

from calibration.arrays import Array, Mask
from calibration.balances.thresholds import UNSEEN_CYCLES


@dataclass(frozen=True)
class Filter:
    """A Gaussian of `sigma` rows within segments, 0: none; or two running means of `boxcar` rows."""

    sigma: float
    boxcar: int = 0

    def __call__(self, full: Array, segment: NDArray[np.int64]) -> Array:
        """Columns (n,) or (n, k) through the filter."""
        if self.boxcar:
            return boxcar(boxcar(full, self.boxcar), self.boxcar)
        return smooth(full, segment, self.sigma)

    def gain(self, cycles: Array | float) -> Array:
        """Part (n,) of sines of `cycles` (n,) per row that passes; none beyond the boxcars' first zero."""
        x = np.asarray(cycles, dtype=float)
        if not self.boxcar:
            return np.asarray(np.exp(-2 * (np.pi * x * self.sigma) ** 2))
        one = np.sinc(x * self.boxcar) / np.sinc(x)
        return np.where(np.abs(x) * self.boxcar < UNSEEN_CYCLES, one**2, 0.0)

    @property
    def passes(self) -> float:
        """Mean square of white noise of 1 behind the filter."""
        if self.boxcar:
            return float(np.sum(self.weights**2))
        return 1.0 / (2.0 * np.sqrt(np.pi)) / max(self.sigma, 1.0) if self.sigma > 0 else 1.0

    @property
    def bends(self) -> float:
        """Mean square of its second difference there; of boxcars over as many rows."""
        if self.boxcar:
            return 6.0 / self.boxcar**4
        return float(3.0 / (8.0 * np.sqrt(np.pi)) / max(self.sigma, 1.0) ** 5)

    @property
    def weights(self) -> Array:
        """Of the rows around one, behind two boxcars."""
        return np.convolve(np.ones(self.boxcar), np.ones(self.boxcar)) / self.boxcar**2


def pieces(label: NDArray[np.int64]) -> list[tuple[int, int]]:
    """Begin and end of every stretch of equal labels."""
    edges = np.flatnonzero(np.diff(label)) + 1
    marks = [0, *edges.tolist(), len(label)]
    return list(itertools.pairwise(marks)) if len(label) else []


def since(mark: Mask, before: int = 10**9) -> NDArray[np.int64]:
    """Rows (n,) since the last that is marked; the one before the first row lies `before` rows back."""
    rows = np.arange(len(mark))
    return np.asarray(rows - np.maximum.accumulate(np.where(mark, rows, -before)))


def by_piece(full: Array, label: NDArray[np.int64], what: Callable[[Array], Array], least: int = 1) -> Array:
    """`what` of every stretch of equal labels; 0 in those of less than `least` rows."""
    out = np.zeros_like(full, dtype=float)
    for a, b in pieces(label):
        if b - a >= least:
            out[a:b] = what(full[a:b])
    return out


def smooth(full: Array, segment: NDArray[np.int64], sigma: float) -> Array:
    """Gaussian low pass of standard deviation `sigma` rows within segments; 0: as it is."""
    if sigma <= 0:
        return full
    return by_piece(full, segment, lambda x: gaussian_filter1d(x, sigma, axis=0, mode="nearest"))


def boxcar(x: Array, width: int) -> Array:
    """Centred mean over `width` (odd) rows along axis 0; the ends repeat."""
    return x if width <= 1 else np.asarray(uniform_filter1d(x, width, axis=0, mode="nearest"))
