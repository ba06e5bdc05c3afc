"""Shapes of the catalogue's unknown: what an effect without a name looks like where physics says it."""

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from calibration.balances.candidate import waves
from calibration.balances.recursions import stop_operator
from calibration.balances.view import View
from calibration.finding import UNKNOWN
from calibration.names.gravity_imbalance import SLOPE_TURN
from calibration.names.lines import line, of_stage
from calibration.names.name import Array, Candidate, Scene, candidate
from calibration.names.unnamed import HARMONICS

SLOW = 4  # knots over time of a scale that moves. ASSUMPTION
FOLLOWS = 2.0  # share: a lagging motor's current that follows the leading one's has 1. ASSUMPTION
FOLLOWING = "the lagging motor's current follows the leading one's, not its own duty"
WIDTHS = (0.02, 0.05, 0.1, 0.2, 0.4)  # part of the usual stroke, of the widest of several loops. ASSUMPTION


def spline_columns(x: Array, knots: int) -> Array:
    """Cubic B-splines of x over its range, `knots` columns without the constant."""
    from scipy.interpolate import BSpline

    low, high = float(np.min(x)), float(np.max(x))
    if high <= low:
        return np.zeros((len(x), 0))
    inner = np.linspace(low, high, knots - 2)
    full = np.concatenate([[low] * 3, inner, [high] * 3])
    columns = BSpline.design_matrix(np.clip(x, low, high), full, 3).toarray()
    return np.asarray(columns[:, 1:])


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
    out = []
    for name, shape in (("drift", drift), ("knot", knots)):
        sizes = (*each(f"scale_{name}", shape, per_place), *each(f"offset_{name}", shape, s.unit))
        out += [over("time", np.hstack([shape * x[:, None], shape]), *sizes)] if sizes else []
    return out


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
    """A force in proportion to the place of a slide (a cable chain, a bellows): wide loops follow it, too.
    Over an angle that is too small for a weight or a cable to be told, it is either."""
    wide = s.view.turn is not None and s.span >= SLOPE_TURN * s.view.turn
    if not s.force or wide or "stiffness" in (*s.view.rig.estimate, *s.view.rig.constants):
        return []
    size = ("stiffness", f"{s.unit}/{s.angle_unit}")
    return [over("axis_angle", s.at(s.view.x - s.view.x.mean()), size)]


def bend(s: Scene) -> list[Candidate]:
    """Friction that bends with the speed, as grease and strain wave gears have it: odd, of second order.

    Where the viscous term was taken out of the balance, as it came out negative, a slope is a part of it."""
    if not s.force or s.view.response.is_speed or "viscous" not in s.declared:
        return []
    part = s.view.speed / (s.view.top or 1.0)
    square, sizes = part * np.abs(part), (("slope", s.unit), ("square", s.unit))
    names = [name for name, _ in s.problem.base_labels]
    out = "viscous" in names and not s.problem.base[:, names.index("viscous")].any()
    columns = np.column_stack([part, square]) if out else square[:, None]
    return [over("velocity", s.at(columns), *sizes[-columns.shape[1] :])]


def of_volts(s: Scene) -> list[Candidate]:
    """Columns of an electrical balance that have no name in the catalogue."""
    w = s.windings
    if w is None or w.counter is None or s.pair is None:
        return _brushes(s)
    c, (a, b) = w.counter, np.split(w.rate, 2)
    # a lagging motor whose current follows the leading one's lacks that one's back-EMF, times its share
    leading = np.tile(np.where(c.lagging[: len(a)] > 0, b, a), 2)
    column = w.constant * w.at(c.share) * c.lagging * leading
    following = over("current", column, ("following", "1"), sign=1, most=FOLLOWS, note=FOLLOWING)
    # brushes over the angle of either motor, as a resistance and as a voltage
    turned = waves(s.view.x[s.view.rows] * s.pair.train.ratio, range(1, HARMONICS + 1))
    more: dict[str, Any] = {"kind": "line", "stage": "motor", "harmonic": 1}
    brushes = [
        over("motor_angle", turned * weight[:, None], ("amplitude", unit), fixed=motor, **more)
        for rows, motor in s.motors
        for weight, unit in ((rows, "V"), (rows * w.at(w.current), "ohm"))
    ]
    return [following, *brushes]


def _brushes(s: Scene) -> list[Candidate]:
    """A resistance over the declared motor's angle, harmonic by harmonic: a rig's zero may move."""
    motors = [replace(g, harmonics=HARMONICS, listed=()) for g in s.view.rig.stages if g.of_motor]
    blank = line(s, UNKNOWN, 0.0, ("amplitude", "ohm"), domain="motor_angle")
    return [c for g in motors for c in of_stage(s, g, blank, s.view.columns["current"])]
