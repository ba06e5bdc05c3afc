"""Nonlinear parameters (a time constant, an onset, a resonance), and onsets that no fitted row saw."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide import thresholds as limits
from calibration.decide.heldout import Model, compare
from calibration.statistics.regression import Fit
from calibration.statistics.surrogate import basis
from calibration.statistics.whitening import Whitener


@dataclass(frozen=True)
class Rest:
    """The fitted rows `train` of a residual (n,) beside a base (n, p), through a filter."""

    train: Mask
    base: Array
    residual: Array
    through: Whitener

    @cached_property
    def white(self) -> Array:
        """The whitened residual of the fitted rows."""
        return self.through.whiten(self.residual, self.train)

    @cached_property
    def basis(self) -> Array:
        """Orthonormal columns that span the whitened base."""
        return basis(self.through.whiten(self.base, self.train))

    def taken(self, columns: Array) -> float:
        """Squares of the whitened residual that columns (n, k) take beside the base."""
        x = self.through.whiten(columns, self.train)
        x = x - self.basis @ (self.basis.T @ x)
        gram, c = x.T @ x, x.T @ self.white
        if np.trace(gram) <= 0:
            return 0.0
        if len(c) == 1:
            return float(c[0] ** 2 / gram[0, 0])
        return float(c @ np.linalg.pinv(gram, rcond=1e-9, hermitian=True) @ c)


def refine(rest: Rest, c: Candidate) -> Candidate:
    """Move nonlinear parameters to where the candidate takes most off the whitened training residual."""
    if (shape := c.shape) is None:
        return c
    at = c.point
    best = rest.taken(shape(at))
    reach = np.array(c.steps) * limits.REFINE_REACH
    for _ in range(limits.REFINE_ROUNDS):
        for k in range(len(at)):
            one = np.arange(len(at)) == k
            trials = [c.inside(at + d * one) for d in np.linspace(-reach[k], reach[k], limits.REFINE_POINTS)]
            values = [rest.taken(shape(trial)) for trial in trials]
            if (most := max(values)) > best or (c.open and most == best):
                ties = [x for x, v in zip(trials, values, strict=True) if v == most]
                best, at = most, np.mean(ties, axis=0) if c.open else ties[0]
        reach /= limits.REFINE_REACH
    return c.moved(at)


def polish(rest: Rest, c: Candidate) -> Candidate:
    """Move nonlinear parameters that depend on each other (onset and ramp) together, of chosen effects."""
    if (shape := c.shape) is None or len(c.steps) < 2:
        return c
    from scipy.optimize import minimize

    at = c.point
    simplex = np.vstack([at, at + np.diag(c.steps)])
    ends = {"maxfev": limits.POLISH_EVALUATIONS, "fatol": 1e-6, "xatol": 1e-6}
    options = {"initial_simplex": simplex, **ends}
    found = minimize(lambda q: -rest.taken(shape(q)), at, method="Nelder-Mead", options=options)
    return c.moved(found.x) if -found.fun > rest.taken(shape(at)) else c


def slopes(c: Candidate, beta: Array) -> Array:
    """(n, len(steps)): d(columns beta)/d(parameter) of the nonlinear parameters, for their intervals."""
    shape, at = c.shape, c.point
    if shape is None:
        return np.zeros((len(c.columns), 0))
    small = np.diag(limits.SLOPE_STEP * np.array(c.steps))
    return np.column_stack([(shape(at + h) - shape(at - h)) @ beta / (2 * h.sum()) for h in small])


def unseen(problem: Problem, c: Candidate) -> tuple[float, float] | None:
    """Earliest and latest onset, s, of a step between which fitted rows see no difference; None without."""
    if "start" not in c.free:
        return None

    def same(onset: float) -> bool:
        return _alike(c, _step(c, onset), problem.train)

    middle = _begin(c)
    if not same(middle):  # as where no row has it
        return None
    low, high = (_edge(same, middle, way) for way in (-1.0, 1.0))
    return (low, high) if high - low > limits.SHORTEST_UNSEEN_S else None


def never_begins(problem: Problem, c: Candidate) -> str:
    """Why a change in time is none, or empty. Either it is on all rows what it would be had it come long
    before, or declared terms move as it does."""
    if "start" not in c.free:
        return ""
    if _alike(c, _step(c, _begin(c) - limits.LONGEST_UNSEEN_S), problem.valid):
        return "it came before the log begins: that is how the drive is, and no change"
    if _own(problem, c) < limits.OWN:
        return "declared terms change with it, and take it as well"
    return ""


def _own(problem: Problem, c: Candidate) -> float:
    """Share of a change's mean square that declared terms cannot take: one over its variance inflation.

    Of the change or of what was before it, whichever is less.
    """
    assert c.shape is not None
    rows = problem.train
    x, base = c.columns[rows], problem.base[rows]
    before = c.shape(_step(c, _begin(c) - limits.LONGEST_UNSEEN_S))[rows] - x
    own = np.sum((x - base @ np.linalg.lstsq(base, x, rcond=None)[0]) ** 2)
    return float(own / max(min(np.sum(x**2), np.sum(before**2)), 1e-300))


def settled(p: Problem, base: Array, c: Candidate, fit: Fit) -> Candidate:
    """The candidate with its step where in an unseen stretch it leaves least on held-out rows.

    Between fitted runs lie pauses, and the run that is held out: all onsets there fit alike. One choice of
    ONSETS is made on held-out rows, like the phase of a line that is every run's own.
    """
    stretch = unseen(p, c)
    if stretch is None or not p.test.any():
        return c

    def left(one: Candidate) -> float:
        model = Model(x=np.hstack([base, one.columns]), beta=fit.beta)
        return compare(p, model, model, fit.whitener).after

    steps = [c.moved(_step(c, onset)) for onset in np.linspace(*stretch, limits.ONSETS).tolist()]
    return min([c, *steps], key=left)


def _begin(c: Candidate) -> float:
    """Its onset; of a ramp the middle."""
    at = {name: value for name, (value, _) in c.fixed.items() if name in c.free}
    return at["start"] + at.get("duration", 0.0) / 2


def _step(c: Candidate, onset: float) -> Array:
    """Its nonlinear parameters as those of a step at `onset`, s."""
    at = {"start": onset, "duration": 0.0}
    return np.array([at.get(name, value) for name, value in zip(c.free, c.point, strict=True)])


def _alike(c: Candidate, p: Array, rows: Mask) -> bool:
    """Whether its columns would be the same with nonlinear parameters `p`."""
    assert c.shape is not None
    off, size = c.shape(p)[rows] - c.columns[rows], c.columns[rows]
    return bool(np.mean(off**2) < limits.ONSET_ALIKE**2 * np.mean(size**2))


def _edge(same: Callable[[float], bool], start: float, way: float) -> float:
    """The last onset, to ONSET_FINE_S, that fits alike when going one way from `start`."""
    good, step = 0.0, 1.0
    while step < limits.LONGEST_UNSEEN_S and same(start + way * step):
        good, step = step, 2 * step
    bad = step
    while bad - good > limits.ONSET_FINE_S:
        half = (good + bad) / 2
        good, bad = (half, bad) if same(start + way * half) else (good, half)
    return start + way * good
