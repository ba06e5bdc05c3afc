"""Shapes of the catalogue's unknown: what an effect without a name looks like where physics says it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from calibration.balances.recursions import stop_operator
from calibration.balances.view import View
from calibration.finding import UNKNOWN
from calibration.names.name import Array, Candidate, Scene, candidate
from calibration.names.spline import spline_columns

# knots over time of a scale that moves. ASSUMPTION
SLOW = 4
# part of the usual stroke, of the widest of several loops. ASSUMPTION
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4)


def over(domain: str, columns: Array, *sizes: tuple[str, str], **more: Any) -> Candidate:
    """`columns` (n_fitted, k) without a name over a domain of the plant; `more` as in a candidate."""
    return candidate(UNKNOWN, columns, *sizes, domain=domain, **more)


def each(label: str, columns: Array, unit: str) -> list[tuple[str, str]]:
    """A size for every column."""
    return [(f"{label}_{k}", unit) for k in range(columns.shape[1])]


def loops(v: View, radii: Sequence[float]) -> Array:
    """(n, k) of height 1."""
    return np.column_stack([stop_operator(v.x, v.file, r) / r for r in radii])


def moving_scale(s: Scene) -> list[Candidate]:
    """Two sensors whose ratio moves with time, steadily or by a smooth function. Thermal growth errs in
    proportion to the distance from where it is held (ISO 230-3). No sensor knows that place, so a drift goes
    with it. A gap and a delay together follow it, too."""
    if s.force:
        return []
    x = s.view.x[s.view.rows]
    x = x - x.mean()
    t = s.problem.t
    span = float(np.ptp(t)) or 1.0
    drift, knots = ((t - t.min()) / span)[:, None], spline_columns(t, SLOW)
    per_place = f"{s.unit}/{s.angle_unit}"
    return [
        over(
            "time",
            np.hstack([shape * x[:, None], shape]),
            *each(f"scale_{name}", shape, per_place),
            *each(f"offset_{name}", shape, s.unit),
        )
        for name, shape in (("drift", drift), ("knot", knots))
        if shape.shape[1]
    ]


def lost_motion(s: Scene) -> list[Candidate]:
    """Two sensors: elastoplastic elements of several widths together (Prandtl-Ishlinskii), the lost motion of
    a strain wave gear (Ruderman, Hoffmann, Bertram 2009). One gap alone is `play`, and cheaper."""
    if s.force or not s.both or s.view.response.ratio == 0:
        return []
    out = []
    for part in WIDTHS:
        radii = [part * s.stroke * f for f in (1.0, 1 / 3, 1 / 9)]
        if radii[-1] >= s.view.resolved:
            sizes = [(f"loop_of_{r:.3g}", s.unit) for r in radii]
            out.append(over("reversal", s.at(loops(s.view, radii)), *sizes, searched=1))
    return out


def spring(s: Scene) -> list[Candidate]:
    """A force in proportion to the place of a slide (a cable chain, a bellows): wide loops follow it, too."""
    if not s.force or s.view.turn or "stiffness" in (*s.view.rig.estimate, *s.view.rig.constants):
        return []
    size = ("stiffness", f"{s.unit}/{s.angle_unit}")
    return [over("axis_angle", s.at(s.view.x - s.view.x.mean()), size)]


def bend(s: Scene) -> list[Candidate]:
    """Friction that bends with the speed, as grease and strain wave gears have it: odd, of second order."""
    if not s.force or s.view.response.is_speed or "viscous" not in s.declared:
        return []
    part = s.view.speed / (s.view.top or 1.0)
    return [over("velocity", s.at(part * np.abs(part)), ("square", s.unit))]
