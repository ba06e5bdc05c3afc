"""Smooth functions of every domain: what an effect outside the catalogue enters the plant as."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.unknown import spline_columns
from calibration.names.scene import Scene
from calibration.readers.run import Array

KNOTS = 8
SLOW = 4  # knots over time of a scale that moves
RADII = (0.002, 0.01, 0.05, 0.2)  # of the usual stroke, of the loops in a flexible fit


def domains(s: Scene) -> list[tuple[str, Array]]:
    """Name and fitted-row values of everything that an effect may be a smooth function of."""
    v, at = s.view, s.view.rows
    out: list[tuple[str, Array]] = [("axis_angle", v.x[at]), ("velocity", v.speed[at]), ("time", v.clock[at])]
    if s.both:
        since = v.since[at]
        unit = float(np.quantile(np.abs(since), 0.5)) * 0.05 + 1e-30
        out.append(("reversal", np.sign(since) * np.log1p(np.abs(since) / unit)))
    t = v.columns.get("temperature")
    if t is not None and np.ptp(t) > 0.5:
        out.append(("temperature", t[at]))
    if not s.force:
        for channel in ("effort", "current", "force"):
            if channel in v.columns:
                out.append(("current", s.at(v.columns[channel])))
    return out


def smooth_functions(s: Scene) -> list[Candidate]:
    """`unknown` over position, speed, travel since reversal, time and temperature; over position and time
    also odd in direction."""
    out = []
    for domain, x in domains(s):
        columns = spline_columns(x, KNOTS)
        if columns.shape[1] == 0:
            continue
        labels = tuple((f"knot_{k}", s.unit) for k in range(columns.shape[1]))
        out.append(Candidate("unknown", domain, columns, labels))
        if s.both and domain in ("axis_angle", "time"):
            odd = columns * s.view.direction[s.view.rows][:, None]
            out.append(Candidate("unknown", domain, odd, labels))
    return out


def moving_scale(s: Scene) -> list[Candidate]:
    """Two sensors whose ratio moves with time: thermal growth errs in proportion to the place (ISO 230-3).

    It has no name in the catalogue, but stands beside the names: a gap and a delay together follow it, too.
    """
    if s.force:
        return []
    knots = spline_columns(s.problem.t, SLOW)
    if knots.shape[1] == 0:
        return []
    x = s.view.x[s.view.rows]
    labels = tuple((f"scale_knot_{k}", f"{s.unit}/{s.angle_unit}") for k in range(knots.shape[1]))
    return [Candidate("unknown", "time", knots * (x - x.mean())[:, None], labels)]


def flexible(s: Scene) -> Array:
    """Columns (n_fitted, k) of a fit that follows anything smooth: what lines are looked for beside."""
    parts = [c.columns for c in smooth_functions(s) if c.domain != "time"]
    return np.hstack([*parts, plain(s)])


def plain(s: Scene) -> Array:
    """Columns (n_fitted, k) of loops, asymmetry and a weight, but nothing that is free over the speed: along
    one kind of ramp a delay is a function of the speed, too."""
    from calibration.candidates.friction import stop_operator

    v = s.view
    parts = [np.zeros((len(s.problem.y), 0))]
    if s.force and s.both:
        parts.append(s.at(np.column_stack([np.abs(v.direction), np.abs(v.speed)])))
        stroke = float(np.quantile(np.abs(v.since[v.ok]), 0.95)) or 1.0
        loops = [stop_operator(v.x, v.file, r * stroke) / (r * stroke) for r in RADII]
        parts.append(s.at(np.column_stack(loops)))
    if s.force and v.turn:
        from calibration.names.gravity_imbalance import gravity

        parts.append(s.at(gravity(s)))
    return np.hstack(parts)


def any_friction_curve(s: Scene) -> Array:
    """Columns (n_fitted, 4): powers of the speed, even and odd, for a friction curve of any smooth shape."""
    v = s.view
    top = float(np.quantile(np.abs(v.speed[v.ok]), 0.98)) or 1.0
    z = v.speed / top
    return s.at(np.column_stack([z**k for k in (2, 3, 4, 5)]))
