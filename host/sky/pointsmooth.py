"""Functions that no term describes: smooth over a variable of the run, or a step at the meridian."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from host.sky.pointfit import NEW, without
from host.sky.pointmodel import Array
from host.sky.pointstars import Stars

_DEGREE = 4
"""Of the polynomial over a variable: a period and a half over its range. ASSUMPTION."""
_FEWEST_KINDS = 8
"""Different values of a variable, twice as many as the polynomial has coefficients. ASSUMPTION."""


@dataclass(frozen=True, kw_only=True)
class Smooth:
    """A function over a variable: its columns, (2 n, k), east-west of all stars, then north-south."""

    over: str
    columns: Array


def functions(stars: Stars) -> list[Smooth]:
    """Candidates over every variable, and for a mirror that flops at the meridian."""
    found = [
        Smooth(over=name, columns=columns)
        for name, values in variables(stars).items()
        for columns in _polynomials(values)
    ]
    sides = _each_way(np.sign(stars.h)[:, None])
    return found + [Smooth(over="hour angle", columns=columns) for columns in sides]


def variables(stars: Stars) -> dict[str, Array]:
    """Columns that errors may depend on, by name, (n,) each."""
    h, d, latitude = stars.h, stars.d, stars.latitude_rad
    altitude = np.arcsin(np.sin(latitude) * np.sin(d) + np.cos(latitude) * np.cos(d) * np.cos(h))
    own = {"hour angle": h, "declination": d, "altitude": altitude, "order of the run": np.arange(len(h))}
    every = own | stars.others
    return {name: each for name, each in every.items() if len(np.unique(each)) >= _FEWEST_KINDS}


def _polynomials(values: Array) -> tuple[Array, Array]:
    """Of degree 1 to `_DEGREE` over a variable."""
    low, high = np.min(values), np.max(values)
    scaled = 2 * (values - low) / (high - low) - 1
    powers = np.polynomial.legendre.legvander(scaled, _DEGREE).astype(np.float64)
    return _each_way(powers[:, 1:])


def _each_way(columns: Array) -> tuple[Array, Array]:
    """Functions of the stars, (n, k), east-west alone and north-south alone: (2 n, k) each."""
    return np.vstack([columns, 0 * columns]), np.vstack([0 * columns, columns])


def chance(design: Array, columns: Array, residuals: Array) -> float:
    """Probability that the columns take as much from noise as from these residuals, beside the design.

    An F test; residuals: (2 n,)."""
    from scipy.stats import f  # only who calibrates needs it

    rest = without(design, residuals)
    new, sizes, _ = np.linalg.svd(without(design, columns), full_matrices=False)
    new = new[:, sizes**2 > NEW * np.max(np.sum(columns**2, axis=0))]
    free = len(rest) - design.shape[1] - new.shape[1]
    if new.shape[1] == 0 or free <= 0:
        return 1.0
    taken = float(np.sum((new.T @ rest) ** 2))
    return float(f.sf(taken / new.shape[1] / ((rest @ rest - taken) / free), new.shape[1], free))
