"""Slips between two sensors: behind one their difference has another offset, as if a sensor started anew.

What comes before a slip says nothing of the offset behind it. So each stretch has its own, on fitted and on
held-out rows, as each file has, and everything else is looked for beside them.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d
from scipy.special import ndtr

from calibration.arrays import Array
from calibration.balances.problem import Problem
from calibration.balances.slowoffset import SLOW
from calibration.balances.view import View
from calibration.decide.energy import signed
from calibration.decide.heldout import cross_validate
from calibration.decide.parameters import interval
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.decide.thresholds import LUCK_Z, MARGIN
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.look.delay import Find, Found, Timed
from calibration.look.jumps import SIDES, jumps_of
from calibration.names.play import NAME as PLAY
from calibration.names.roller_slip import NAME
from calibration.names.scene import Scene
from calibration.statistics.regression import solve
from calibration.statistics.thresholds import SURE_Z

# robust standard errors of a slip that is tried. ASSUMPTION: an offset that walks has steps of 4.9
CLEAR = 5.0
# of all reversals, that may have a jump: play jumps at every one, and back at the next. ASSUMPTION
PLAYS = 0.5
BESIDE = 2  # fitted rows, by which the filter may have moved a slip. ASSUMPTION: a standard deviation is one
BORDER = 24  # rows at either side of a file's border that show no slip. ASSUMPTION
TRIED = 33  # places that are tried about a slip, and once more about the best of them. ASSUMPTION


def slipped(whole: Problem, found: Found, view: View, find: Find) -> Timed:
    """`found` on `whole`, or the search beside slips where they explain what nothing else does. Jumps at the
    reversals are a gap's."""
    s, scene, bounds = found
    least = s.held.after
    # steps look like something slow
    s = s.keep([x for x in s.chosen if (x.candidate.name, x.candidate.domain) != (UNKNOWN, "time")])
    # where a file begins, columns that look back are no measurement
    begins = maximum_filter1d(np.diff(s.problem.session, prepend=-1) != 0, 2 * BORDER + 1)
    places, turns = [at for at in jumps_of(s, CLEAR) if not begins[at]], _turns(view, s.problem)
    turning = {at for at in places if np.any(np.abs(turns - at) <= SIDES[0])}
    if len(turning) > PLAYS * len(turns):
        places = [at for at in places if at not in turning]
        s = _with_gap(s, scene)
        found, least = (s, scene, bounds), s.held.after
    # a slip that is past says nothing on held-out rows behind it, nor fitted rows of one among these: pieces
    # of all rows tell
    everywhere = replace(s.problem, held=np.zeros_like(s.problem.held))
    steps = _sure(s, everywhere, _placed(s, places, view), view)
    if not steps:
        return Timed(whole, found)
    beside = np.column_stack([s.columns, *steps.values()])
    inside = cross_validate(everywhere, s.columns, beside, s.after.whitener)
    if inside.z < LUCK_Z or inside.share < MARGIN:
        return Timed(whole, found)
    apart = _apart(s.problem, list(steps.values()))
    again = find(apart)
    if again[0].held.after > least:
        return Timed(whole, found)
    first = _finding(again[0], list(steps), view, inside.share)
    return Timed(apart, again, first, Selection.of(s.problem))


def _turns(view: View, p: Problem) -> NDArray[np.int64]:
    """Fitted rows on which the motion goes the other way for the first time, file by file."""
    way = np.sign(view.direction[view.rows])
    moving = np.flatnonzero(way != 0)
    changed = (np.diff(way[moving]) != 0) & (np.diff(p.session[moving]) == 0)
    return np.asarray(moving[1:][changed], dtype=np.int64)


def _with_gap(s: Selection, scene: Scene) -> Selection:
    """With the gap that leaves least on held-out rows, where `s` has none: reversals show it one by one."""
    if any(c.name == PLAY.name for c in s.candidates):
        return s
    fits = [one for c in PLAY.columns(scene) if (one := fit_with(s.problem, s.columns, c)) is not None]
    best = min((s.keep([*s.chosen, one]) for one in fits), key=lambda x: x.held.after, default=s)
    share = 1 - (best.held.after / s.held.after) ** 2 if s.held.after > 0 else 0.0
    if not share > MARGIN:
        return s
    kept = replace(best.chosen[-1], held=replace(best.held, share=share))
    return signed(best.keep([*s.chosen, kept]))


def _placed(s: Selection, places: list[int], view: View) -> dict[int, Array]:
    """Full-rate rows of the slips, and steps (n_fitted,) there through the balance's filter: each near its
    fitted row, where it leaves least beside the others."""
    p, rows = s.problem, [int(view.rows[at]) for at in places]
    steps = [_step(view, row) for row in rows]
    for k, at in enumerate(places):
        others = np.column_stack([s.columns, *(x for j, x in enumerate(steps) if j != k)])[p.valid]

        def gain(row: int, others: Array = others) -> float:
            one = _step(view, row)[p.valid]
            one = one - others @ solve(others, one)
            return float(one @ p.y[p.valid]) ** 2 / max(float(one @ one), 1e-300)

        first, last = max(at - BESIDE, 0), min(at + BESIDE, len(view.rows) - 1)
        low, high = int(view.rows[first]), int(view.rows[last])
        for _ in range(2):
            spacing = max((high - low) // TRIED, 1)
            rows[k] = max(range(low, high + 1, spacing), key=gain)
            low, high = rows[k] - spacing, rows[k] + spacing
        steps[k] = _step(view, rows[k])
    return dict(zip(rows, steps, strict=True))


def _step(view: View, row: int) -> Array:
    """(n_fitted,): 0 before a full-rate row of its file and 1 from there on, behind the filter."""
    since = view.rows - row
    shape = ndtr((since + 0.5) / view.sigma) if view.sigma > 0 else (since >= 0).astype(float)
    return np.where(view.file[view.rows] == view.file[row], shape, 0.0)


def _sure(s: Selection, everywhere: Problem, steps: dict[int, Array], view: View) -> dict[int, Array]:
    """Those that are more than their own errors, and than half a count, the error of a reading.

    A drift through a count looks like a slip.
    """
    r, step = view.response, view.quanta
    half = 0.5 * max(step.get(r.channel, 0.0) * abs(r.gain), step.get("position", 0.0) * abs(r.ratio or 1.0))
    fit = everywhere.fit(np.column_stack([s.columns, *steps.values()])) if steps else s.after
    first = s.columns.shape[1]
    clear = np.abs(fit.beta[first:]) > np.maximum(SURE_Z * fit.errors[first:], half)
    return {row: x for (row, x), good in zip(steps.items(), clear, strict=True) if good} if steps else {}


def _apart(p: Problem, steps: list[Array]) -> Problem:
    """With an offset for every stretch between slips."""
    return replace(
        p,
        base=np.column_stack([p.base, *steps]),
        base_labels=[*p.base_labels, *[(SLOW, p.unit)] * len(steps)],
        fresh=np.column_stack([x for x in (p.fresh, *steps) if x is not None]),
    )


def _finding(s: Selection, rows: list[int], view: View, share: float) -> Finding:
    """The largest slip, with those at all `rows` of full rate in the note. Sizes are those of all rows: one
    that lies among the held-out ones has none on the others."""
    p = replace(s.problem, held=np.zeros_like(s.problem.held), turned=None)
    fit = p.fit(s.columns)
    first = [label for label, _ in p.base_labels].index(SLOW)
    sizes, errors = (x[first:][: len(rows)] for x in (fit.beta, fit.errors))
    each = zip(sizes, view.t[rows], view.file[rows], strict=True)
    told = [f"{x:.3g} {p.unit} at {t:.4g} s of file {k + 1}" for x, t, k in each]
    k = int(np.argmax(np.abs(sizes)))
    low, high = interval(float(sizes[k]), float(errors[k]), p.blocks, None)
    at = {
        "step": Parameter(float(sizes[k]), p.unit, low, high),
        "time": Parameter(float(view.t[rows[k]]), "s"),
    }
    return Finding(NAME.name, p.channel, "time", parameters=at, share=share, note=f"slips: {', '.join(told)}")
