"""Slips between two sensors: from a slip on, the difference has another offset, as a sensor has that starts.

What comes before a slip says nothing of the offset behind it. So each stretch has its own, on fitted and on
held-out rows, as each file has, and everything else is looked for beside them.
"""

from dataclasses import replace
from functools import partial

import numpy as np
from scipy.ndimage import maximum_filter1d

from calibration.arrays import Array
from calibration.balances.problem import Problem
from calibration.balances.slowoffset import SLOW
from calibration.balances.view import View
from calibration.decide import rules
from calibration.decide.parameters import interval
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import MARGIN
from calibration.finding import Finding, Parameter
from calibration.look.delay import Find, Found, Timed
from calibration.look.jumps import SIDES, jumps_of
from calibration.look.worm import FREE_GAIN
from calibration.names.play import NAME as PLAY
from calibration.names.roller_slip import NAME
from calibration.names.scene import Scene
from calibration.statistics.regression import solve

# of all reversals, that may have a jump: play jumps at every one, and back at the next. ASSUMPTION
PLAYS = 0.5
# fitted rows, by which the filter may have moved a slip. ASSUMPTION: a standard deviation is one
BESIDE = 2


def slipped(whole: Problem, found: Found, view: View, find: Find) -> Timed:
    """`found` on `whole`, or what is found beside slips where they explain what nothing else does. Jumps at
    the reversals are a gap's."""
    s, scene, bounds = found
    # where a file begins, columns that look back are no measurement
    begins = maximum_filter1d(np.diff(whole.session, prepend=-1) != 0, 2 * SIDES[-1] + 1)
    places = [at for at in jumps_of(s) if not begins[at]]
    turns = np.flatnonzero(np.diff(view.direction[view.rows]) != 0)
    turning = {at for at in places if np.any(np.abs(turns - at) <= SIDES[0])}
    if len(turning) > PLAYS * len(turns):
        places = [at for at in places if at not in turning]
        s = _with_gap(s, scene)
        found = s, scene, bounds
    if not places:
        return Timed(whole, found)
    rows, steps = _steps(s, places, view)
    apart = _apart(whole, steps)
    again = find(apart)
    left, was = again[0].held.after, s.held.after
    if not left**2 < (1 - FREE_GAIN) * was**2:
        return Timed(whole, found)
    before = Selection.of(whole).held.before
    share = max(1 - (again[0].held.before / before) ** 2, 0.0) if before > 0 else 0.0
    return Timed(apart, again, _finding(again[0], rows, view, share), before)


def _with_gap(s: Selection, scene: Scene) -> Selection:
    """With the gap that leaves least on held-out rows, where `s` has none: reversals show it one by one."""
    if any(c.name == PLAY.name for c in s.candidates):
        return s
    fits = (fit_with(s.problem, s.columns, c) for c in PLAY.columns(scene))
    tried = [s.keep([*s.chosen, one]) for one in fits if one is not None]
    best = min(tried, key=lambda x: x.held.after, default=s)
    return rules.signed(best) if best.held.after**2 < (1 - MARGIN) * s.held.after**2 else s


def _steps(s: Selection, places: list[int], view: View) -> tuple[list[int], list[Array]]:
    """Full-rate rows of the slips, and steps (n_fitted,) there through the balance's filter: each near its
    fitted row, where it leaves least beside the others."""
    p, full = s.problem, np.arange(len(view.t))

    def step(row: int) -> Array:
        return view.at(((full >= row) & (view.file == view.file[row])).astype(float))

    def left(others: list[Array], row: int) -> float:
        x = np.column_stack([s.columns, *others, step(row)])[p.valid]
        return float(np.sum((p.y[p.valid] - x @ solve(x, p.y[p.valid])) ** 2))

    rows = [int(view.rows[at]) for at in places]
    steps = [step(row) for row in rows]
    for k, at in enumerate(places):
        first, last = max(at - BESIDE, 0), min(at + BESIDE, len(view.rows) - 1)
        others = [x for j, x in enumerate(steps) if j != k]
        near = range(view.rows[first], view.rows[last] + 1)
        rows[k] = min(near, key=partial(left, others))
        steps[k] = step(rows[k])
    return rows, steps


def _apart(p: Problem, steps: list[Array]) -> Problem:
    """With an offset for every stretch between slips."""
    return replace(
        p,
        base=np.column_stack([p.base, *steps]),
        base_labels=[*p.base_labels, *[(SLOW, p.unit)] * len(steps)],
        fresh=np.column_stack([x for x in (p.fresh, *steps) if x is not None]),
    )


def _finding(s: Selection, rows: list[int], view: View, share: float) -> Finding:
    """The largest slip, with those at all `rows` of full rate in the note."""
    p = s.problem
    first = [label for label, _ in p.base_labels].index(SLOW)
    sizes, errors = (x[first:][: len(rows)] for x in (s.after.beta, s.after.errors))
    each = zip(sizes, view.t[rows], view.file[rows], strict=True)
    told = [f"{x:.3g} {p.unit} at {t:.4g} s of file {k + 1}" for x, t, k in each]
    k = int(np.argmax(np.abs(sizes)))
    low, high = interval(float(sizes[k]), float(errors[k]), p.blocks, None)
    size = Parameter(float(sizes[k]), p.unit, low, high)
    at = {"step": size, "time": Parameter(float(view.t[rows[k]]), "s")}
    note = f"slips: {', '.join(told)}"
    return Finding(NAME.name, p.channel, "time", parameters=at, share=share, note=note)
