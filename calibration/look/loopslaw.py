"""An effort that a loop commands: its law explains it, and says nothing of the forces."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.decide.thresholds import STILL_MISSING
from calibration.statistics.regression import solve
from calibration.statistics.tails import rms

#: responses that a loop commands
COMMANDED = ("effort", "current", "voltage")
# of its variation, that such a law leaves at most. ASSUMPTION: friction's corners leave more
EXACT = 0.01
# of what the forces leave on rows held out, that a law leaves at most to be told beside them. ASSUMPTION
TOLD = 0.5


def law_of_its_loop(view: View, p: Problem, floor: float | None) -> str:
    """Why an effort that is its loop's law, and so says nothing of forces, cannot be tested; or empty.

    A loop at rest at one set point pulls back, in proportion to the place; a drive's own forces do not.
    """
    if not view.dynamic or view.response.channel not in COMMANDED or not floor:
        return ""
    rows, unit = p.valid, view.unit
    x = _law(view, view.x[view.rows])[rows]
    constant, slope, rate = solve(x, p.y[rows])
    least = min(STILL_MISSING * floor, EXACT * float(np.std(p.y[rows])))
    forces = rms(p.plain_fit(rows)[1][rows])  # a mass along one sine pulls back in proportion, too
    if slope >= 0 or forces <= least or not rms(p.y[rows] - x @ [constant, slope, rate]) <= least:
        return ""
    told = f"{constant:.4g} {unit} - {-slope:.4g} {unit}/{view.angle_unit} x position"
    why = "That is the law of a loop with one set point, beside which no force shows: move the set point"
    return f"{view.response.channel} is {told}. {why}"


def follows(view: View, p: Problem, left: float) -> list[str]:
    """That an effort follows the reference far better than the forces, which leave `left` rms."""
    if view.rig.controller is not None or "reference" not in view.columns or not view.dynamic:
        return []
    p, channel, unit = p.once, view.response.channel, view.unit
    if channel not in COMMANDED or not p.test.any():
        return []
    x = _law(view, view.at(view.columns["reference"] - view.x))
    beta = solve(x[p.train], p.y[p.train])
    law = rms(p.y[p.test] - x[p.test] @ beta)
    _, gain, damping = beta
    if gain <= 0 or not law < TOLD * left:
        return []
    told = f"{gain:.3g} {unit}/{view.angle_unit} x (reference - position) {'+' if damping > 0 else '-'}"
    told += f" {abs(damping):.3g} {unit} s/{view.angle_unit} x velocity"
    told += f" leaves {law:.3g} {unit} where the forces leave {left:.3g}"
    return [f"{channel} is what its loop commands: {told}. Declare the law as `controller`"]


def _law(view: View, place: Array) -> Array:
    """Columns (n_fitted, 3) of a loop's law: a constant, the place or its error, the rate."""
    return np.column_stack([np.ones(len(place)), place, view.at(view.smoothed(view.rate(view.x)))])
