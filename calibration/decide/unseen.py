"""A step in time that no fitted row saw: it may lie anywhere between two of them.

Between the runs that are fitted lie pauses, and the run that is held out. All onsets there fit alike, and
which of them a search stops at is rounding. The step is put at that one of PLACES over the stretch with
which the held-out rows agree best: one choice of nine made on held-out rows, like the phase of a line that
is every run's own. The interval of the onset is the whole stretch.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.decide.heldout import compare
from calibration.decide.scan import Contender
from calibration.readers.run import Array

PLACES = 9  # over a stretch, both ends among them
ALIKE = 0.01  # of the columns' rms on fitted rows
SHORTEST, LONGEST, FINE = 2.0, 1e4, 0.25  # s: a stretch worth the name, its reach, and how finely it is told


def unseen(problem: Problem, c: Candidate) -> tuple[float, float] | None:
    """Earliest and latest onset, s, of a step that fitted rows cannot tell from the candidate's; None when
    they see it, or it has no onset."""
    names = list(c.fixed)[: len(c.steps)]
    if "onset" not in names or c.shape is None:
        return None
    at, shape, rows = _as_step(c), c.shape, problem.train
    size = float(np.sqrt(np.mean(c.columns[rows] ** 2)))

    def same(onset: float) -> bool:
        off = shape(_with(names, at, onset))[rows] - c.columns[rows]
        return bool(float(np.sqrt(np.mean(off**2))) < ALIKE * size)

    middle = at[names.index("onset")]
    if size == 0.0 or not same(middle):
        return None
    low, high = (_edge(same, middle, way) for way in (-1.0, 1.0))
    return (low, high) if high - low > SHORTEST else None


def never_begins(problem: Problem, c: Candidate) -> str:
    """Why a change in time is none: over the whole log, held-out rows included, it is what it would be had it
    come long before; or empty."""
    names = list(c.fixed)[: len(c.steps)]
    if "onset" not in names or c.shape is None:
        return ""
    at, rows = _as_step(c), problem.valid
    before = c.shape(_with(names, at, at[names.index("onset")] - LONGEST))[rows]
    size = float(np.sqrt(np.mean(c.columns[rows] ** 2)))
    if float(np.sqrt(np.mean((before - c.columns[rows]) ** 2))) >= ALIKE * size:
        return ""
    return "it came before the log begins: that is how the drive is, and no change"


def settled(problem: Problem, base: Array, contender: Contender) -> Contender:
    """The contender with its step where in an unseen stretch it leaves least on held-out rows."""
    c = contender.candidate
    stretch = unseen(problem, c)
    if stretch is None or c.shape is None or not problem.test.any():
        return contender
    names, fit = list(c.fixed)[: len(c.steps)], contender.fit
    tried = [contender]
    for onset in np.linspace(*stretch, PLACES).tolist():
        p = _with(names, _as_step(c), onset)
        fixed = {**c.fixed, **{n: (float(v), c.fixed[n][1]) for n, v in zip(names, p, strict=True)}}
        tried.append(replace(contender, candidate=replace(c, columns=c.shape(p), fixed=fixed)))

    def left(one: Contender) -> float:
        x = np.hstack([base, one.candidate.columns])
        return compare(problem, x, fit.beta, x, fit.beta, fit.whitener).after

    return min(tried, key=left)


def _as_step(c: Candidate) -> Array:
    """Nonlinear parameters with the ramp, if it has one, as a step in its middle."""
    names = list(c.fixed)[: len(c.steps)]
    p = np.array([c.fixed[n][0] for n in names])
    if "ramp" in names:
        p[names.index("onset")] += p[names.index("ramp")] / 2
        p[names.index("ramp")] = 0.0
    return p


def _with(names: list[str], p: Array, onset: float) -> Array:
    out = p.copy()
    out[names.index("onset")] = onset
    return out


def _edge(same: Callable[[float], bool], start: float, way: float) -> float:
    """The last onset, to FINE, that fits alike when going one way from `start`."""
    good, step = 0.0, 1.0
    while step < LONGEST and same(start + way * step):
        good, step = step, 2 * step
    bad = step
    while bad - good > FINE:
        half = (good + bad) / 2
        good, bad = (half, bad) if same(start + way * half) else (good, half)
    return start + way * good
