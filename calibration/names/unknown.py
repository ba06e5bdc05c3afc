"""Smooth functions of every domain: what an effect outside the catalogue enters the plant as."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.unknown import spline_columns
from calibration.names.scene import Scene
from calibration.readers.run import Array

KNOTS = 8
SLOW = 4  # knots over time of a scale that moves
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4)  # of the usual stroke, of the widest of several loops
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
    if s.force and s.view.dynamic:
        out.append(("current", _declared_force(s)))
    if not s.force:
        for channel in ("effort", "current", "force"):
            if channel in v.columns:
                out.append(("current", s.at(v.columns[channel])))
    return out


def _declared_force(s: Scene) -> Array:
    """The response as declared terms and names have it (n_fitted,): a gain that depends on the effort is a
    function of it. Not the response itself, whose noise it would share."""
    if s.model is not None:
        return s.model
    p = s.problem
    beta = np.linalg.lstsq(p.base[p.train], p.y[p.train], rcond=1e-8)[0]
    return np.asarray(p.base @ beta)


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
        if s.force and s.view.dynamic and domain == "axis_angle":
            out.append(Candidate("unknown", domain, columns * _declared_force(s)[:, None], labels))
    return out


def moving_scale(s: Scene) -> list[Candidate]:
    """Two sensors whose ratio moves with time, steadily or by a smooth function: thermal growth errs in
    proportion to the distance from where it is held (ISO 230-3), which no sensor knows the place of: a drift
    goes with it.

    It has no name in the catalogue, but stands beside the names: a gap and a delay together follow it, too.
    """
    if s.force:
        return []
    x = s.view.x[s.view.rows]
    x = x - x.mean()
    t = s.problem.t
    span = float(np.ptp(t)) or 1.0
    out = []
    for name, shape in (("drift", ((t - t.min()) / span)[:, None]), ("knot", spline_columns(t, SLOW))):
        width = shape.shape[1]
        labels = [(f"scale_{name}_{k}", f"{s.unit}/{s.angle_unit}") for k in range(width)]
        labels += [(f"offset_{name}_{k}", s.unit) for k in range(width)]
        if width:
            columns = np.hstack([shape * x[:, None], shape])
            out.append(Candidate("unknown", "time", columns, tuple(labels)))
    return out


def lost_motion(s: Scene) -> list[Candidate]:
    """Two sensors: elastoplastic elements of several widths together (Prandtl-Ishlinskii), the lost motion of
    a strain wave gear (Ruderman, Hoffmann, Bertram 2009). One gap alone is `play`, and cheaper."""
    from calibration.candidates.friction import stop_operator

    if s.force or not s.both or s.view.response.ratio == 0:
        return []
    v = s.view
    stroke = float(np.quantile(np.abs(v.since[v.ok]), 0.95)) or 1.0
    out = []
    for part in WIDTHS:
        radii = [part * stroke * f for f in (1.0, 1 / 3, 1 / 9)]
        if radii[-1] < v.resolved:
            continue
        full = np.column_stack([stop_operator(v.x, v.file, r) / r for r in radii])
        labels = tuple((f"loop_of_{r:.3g}", s.unit) for r in radii)
        out.append(Candidate("unknown", "reversal", s.at(full), labels, searched=1))
    return out


def spring(s: Scene) -> list[Candidate]:
    """A force in proportion to the place of a slide (a cable chain, a bellows). It has no name in the
    catalogue, but stands beside the names: wide loops follow it, too."""
    if not s.force or s.view.turn or "stiffness" in (*s.view.rig.estimate, *s.view.rig.constants):
        return []
    x = s.view.x - s.view.x.mean()
    return [
        Candidate("unknown", "axis_angle", s.at(x)[:, None], (("stiffness", f"{s.unit}/{s.angle_unit}"),))
    ]


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
