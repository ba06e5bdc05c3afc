"""Shapes of the catalogue's unknown: what an effect without a name looks like where physics says it."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from calibration.balances.recursions import stop_operator
from calibration.balances.view import View
from calibration.finding import UNKNOWN
from calibration.names.candidates import tried
from calibration.names.name import Array, Candidate, Scene, candidate
from calibration.names.spline import spline_columns

# knots over time of a scale that moves. ASSUMPTION
SLOW = 4
# part of the usual stroke, of the widest of several loops. ASSUMPTION
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4)
# fits of the declared terms beside a force's own square, until both hold still. ASSUMPTION
SETTLED = 5
# part of the range, where an end stop may begin, from the other end. ASSUMPTION: a margin of a stroke
BEGINS = (0.5, 0.6, 0.7, 0.8, 0.9)
# part of the range, a small change of that place. ASSUMPTION
PLACE_STEP = 0.01


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


def alone(s: Scene) -> list[Candidate]:
    """Shapes that imitate sums of names, and are looked for beside none: an end stop, a torque that bends.
    Beside an offset that wanders within a file either would be any slope over one stroke."""
    wanders = s.view.slow_offset > 0 or s.view.response.channel == "acceleration"
    return (
        []
        if not s.force or not s.view.dynamic or s.pair is not None or wanders
        else [*_saturation(s), *_end_stop(s)]
    )


def _saturation(s: Scene) -> list[Candidate]:
    """Torque that falls behind its effort, as iron saturates: the square of the force that the declared terms
    make beside it."""
    force = s.declared_part
    for _ in range(SETTLED):
        bent = force * np.abs(force) / (float(np.max(np.abs(force))) or 1.0)
        force = s.fitted(bent[:, None])[1]
    return [over("current", bent, ("square", s.unit))]


def _end_stop(s: Scene) -> list[Candidate]:
    """A buffer of rubber at one end of the stroke: stiffer the further it is pressed, no force before."""
    x, ok = s.view.x, s.view.ok
    low, high = float(np.min(x[ok])), float(np.max(x[ok]))
    span = (high - low) or 1.0
    out = []
    for side, end in ((1.0, low), (-1.0, high)):

        def full(p: Array, side: float = side) -> Array:
            return np.asarray(side * np.maximum(side * (x - p[0]), 0.0) ** 2 / span**2)

        for part in BEGINS:
            at = {"begin": (end + side * part * span, s.angle_unit)}
            more: dict[str, Any] = {"domain": "axis_angle", "positive": (0,), "steps": (PLACE_STEP * span,)}
            out.append(tried(UNKNOWN, s.shaped(full), ("square", s.unit), at=at, **more))
    return out
