"""Smooth functions of each domain: what an effect outside the catalogue enters the plant as."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.readers.run import Array


def spline_columns(x: Array, knots: int, period: float | None = None) -> Array:
    """Cubic B-splines of x over its range (or periodic), `knots` columns without the constant."""
    if period:
        z = (x / period) % 1.0
        return np.column_stack(
            [f(2 * np.pi * h * z) for h in range(1, knots // 2 + 1) for f in (np.cos, np.sin)]
        )
    from scipy.interpolate import BSpline

    low, high = float(np.min(x)), float(np.max(x))
    if high <= low:
        return np.zeros((len(x), 0))
    inner = np.linspace(low, high, knots - 2)
    full = np.concatenate([[low] * 3, inner, [high] * 3])
    columns = BSpline.design_matrix(np.clip(x, low, high), full, 3).toarray()
    return np.asarray(columns[:, 1:])


def smooth_functions(c: Context, knots: int = 8) -> list[Candidate]:
    """`unknown` over angle, speed, travel since reversal, time, and each of them odd in direction."""
    domains: list[tuple[str, Array]] = [("axis_angle", c.angle), ("velocity", c.speed), ("time", c.t)]
    if np.mean(c.direction > 0) > 0.05 and np.mean(c.direction < 0) > 0.05:
        domains.append(
            (
                "reversal",
                np.sign(c.since)
                * np.log1p(np.abs(c.since) / (np.quantile(np.abs(c.since), 0.5) * 0.05 + 1e-30)),
            )
        )
    if c.current is not None:
        domains.append(("current", c.current))
    if c.effort is not None:
        domains.append(("command", c.effort))
    if c.temperature is not None and np.ptp(c.temperature) > 0.5:
        domains.append(("temperature", c.temperature))
    out = []
    for domain, x in domains:
        columns = spline_columns(x, knots)
        if columns.shape[1] == 0:
            continue
        labels = tuple((f"knot_{k}", c.unit) for k in range(columns.shape[1]))
        out.append(Candidate("unknown", domain, columns, labels))
    return out
