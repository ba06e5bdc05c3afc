"""Rows that are held out, errors on rows that were not fitted, and whether a gain is more than luck."""

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.balances.candidate import pairs_by_section
from calibration.balances.frame import Frame, fill
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_FILES
from calibration.decide import thresholds as limits
from calibration.statistics.regression import solve, solve_without, told
from calibration.statistics.tails import rms
from calibration.statistics.whitening import Whitener


@dataclass(frozen=True, kw_only=True)
class HeldOut:
    """rms before and after on held-out rows (channel's unit), z-score of the whitened gain over blocks."""

    before: float = float("nan")
    after: float = float("nan")
    z: float = 0.0
    share: float = 0.0  # 1 - mean square after / before
    everywhere: bool = False  # cross-validation only: every fold gained
    apart: bool = False  # nothing was fitted to these rows, not even in another turn

    @property
    def taken(self) -> float:
        """The mean square that is taken off."""
        return self.before**2 - self.after**2

    @property
    def sure(self) -> bool:
        """Whether the gain is more than luck, and more than rounding."""
        return self.z > limits.LUCK_Z and self.share > limits.ROUNDING


@dataclass(frozen=True, kw_only=True)
class Model:
    """Columns x (n, p), fitted coefficients beta (p,), and columns whose phase is every run's own."""

    x: Array
    beta: Array
    phases: Sequence[slice] = ()

    def residual(self, problem: Problem, rows: Mask) -> Array:
        """y - x beta on `rows`, with offsets of new segments and phases of new runs fitted there."""
        e = problem.y[rows] - self.x[rows] @ self.beta
        for at in self.phases:
            e = e - _new_phase(self.x[:, at], self.beta[at], problem.train, rows, e)
        if problem.fresh is not None:
            f = problem.fresh[rows]
            e = e - f @ solve(f, e)
        return np.asarray(e)

    def left_out(self, problem: Problem) -> Array:
        """(n_test,): the held-out residual; of sessions in turn, each beside the others' coefficients."""
        if problem.turned is None:
            return self.residual(problem, problem.test)
        if problem.slow:
            return self._beside_nuisances(problem)
        out = np.zeros(len(problem.y))
        betas = solve_without(self.x[problem.valid], problem.y[problem.valid], problem.session[problem.valid])
        for part, beta in zip(problem.turns, betas, strict=True):
            rows = part.test
            out[rows] = replace(self, beta=beta).residual(part, rows)
        return np.asarray(out[problem.test])

    def _beside_nuisances(self, problem: Problem) -> Array:
        """Likewise: what the declared terms take of all rows is nobody's, of the effects as of y."""
        rows, base = problem.valid, problem.base[problem.valid]
        both = np.column_stack([self.x[rows, base.shape[1] :], problem.y[rows]])
        both -= base @ np.linalg.lstsq(base, both, rcond=None)[0]
        x, y = both[:, :-1], both[:, -1]
        labels, part = np.unique(problem.session[rows], return_inverse=True)
        betas = np.reshape(solve_without(x, y, part), (len(labels), -1))
        return np.asarray(y - np.einsum("ij,ij->i", x, betas[part]))


def _new_phase(pairs: Array, beta: Array, train: Mask, rows: Mask, e: Array) -> Array:
    """What lines of known amplitude and new phase in a run (cos, sin) take off `e`; the j-th pair is a
    harmonic."""
    known: dict[int, list[float]] = {}
    fresh: list[tuple[slice, int]] = []
    for harmonic, k in (x for section in pairs_by_section(pairs) for x in enumerate(section)):
        at = slice(k, k + 2)
        if np.any(pairs[train, at]):
            known.setdefault(harmonic, []).append(float(np.hypot(*beta[at])))
        elif np.any(pairs[rows, at]):
            fresh.append((at, harmonic))
    fresh = [(at, h) for at, h in fresh if h in known]
    if not fresh:
        return np.zeros(len(e))
    waves = [pairs[rows, at] for at, _ in fresh]
    found = solve(np.hstack(waves), e).reshape(-1, 2)
    sizes = np.array([np.median(known[h]) for _, h in fresh]) / np.maximum(np.hypot(*found.T), 1e-300)
    return np.asarray(np.hstack(waves) @ (found * sizes[:, None]).ravel())


def declared_residual(p: Problem) -> Array:
    """Held-out residual of the declared terms alone."""
    return Model(x=p.base, beta=p.fit().beta, phases=p.base_phases).left_out(p)


def compare(problem: Problem, before: Model, after: Model, whitener: Whitener) -> HeldOut:
    """Compare two fitted models on the held-out rows."""
    rows = problem.test
    if rows.sum() < limits.FEWEST_HELD:
        return HeldOut()
    e0, e1 = (m.left_out(problem) for m in (before, after))
    full = np.zeros((len(problem.y), 2))
    full[rows] = np.column_stack([e0, e1])
    white = whitener.whiten(full, rows) ** 2
    found = _scored(e0, e1, paired_z(white[:, 0] - white[:, 1], problem.block))
    return replace(found, apart=problem.turned is None)


def _scored(e0: Array, e1: Array, z: float, everywhere: bool = False) -> HeldOut:
    b, a = rms(e0), rms(e1)
    share = 1 - (a / b) ** 2 if b > 0 else 0.0
    return HeldOut(before=b, after=a, z=z, share=share, everywhere=everywhere)


def paired_z(gain: Array, block: int) -> float:
    """z-score of the mean gain over blocks of rows."""
    if len(gain) < 2 * block:
        block = max(len(gain) // 4, 1)
    edges = np.arange(0, len(gain), block)
    sums = np.add.reduceat(gain, edges) if len(gain) else np.zeros(1)
    if len(sums) < 2 or np.std(sums) == 0:
        return 0.0
    return float(np.mean(sums) / (np.std(sums, ddof=1) / np.sqrt(len(sums))))


def folds(problem: Problem, use: Mask) -> NDArray[np.int64]:
    """Fold of every row in `use`: pieces of a run in turn, every run's from the next fold on.

    A piece lasts FOLD_S, or less where that would leave a fold with fewer than PER_FOLD pieces.
    """
    run, t = problem.run[use], problem.t[use]
    runs, order = np.unique(run, return_inverse=True)
    since = t - np.array([t[run == k].min() for k in runs])[order]
    total = sum(float(since[run == k].max()) + problem.period_s for k in runs)
    longest = min(limits.FOLD_S, total / (limits.FOLDS * limits.PER_FOLD))
    piece = np.floor(since / max(longest, limits.LEAST_PIECE * problem.period_s) + 1e-9).astype(np.int64)
    rank = np.unique(order * (piece.max(initial=0) + 1) + piece, return_inverse=True)[1]
    first = np.array([rank[run == k].min() for k in runs])
    return np.asarray((rank - first[order] + order) % limits.FOLDS, dtype=np.int64)


def cross_validate(problem: Problem, x0: Array, x1: Array, whitener: Whitener) -> HeldOut:
    """Score two designs on training rows they were not fitted to, in FOLDS folds of pieces in time.

    Rows that the others do not tell are not used. Not a number where the others make fewer than two folds.
    """
    rows = problem.train
    use = whitener.usable(rows)
    if use.sum() < limits.FEWEST_VALIDATED:
        return HeldOut()
    fold = folds(problem, use)
    y = whitener.whiten(problem.y, rows)
    residuals: list[Array] = []
    tested = np.ones(len(y), dtype=bool)
    for x in (x0, x1):
        w = whitener.whiten(x, rows)
        e = np.empty(len(y))
        for k in np.unique(fold):
            out = fold == k
            e[out] = y[out] - w[out] @ solve(w[~out], y[~out])
            if x is x1:
                tested[out] = told(w[~out], w[out])
        residuals.append(e)
    dealt = np.unique(fold[tested])
    if tested.sum() < limits.FEWEST_VALIDATED or len(dealt) < 2:
        return HeldOut()
    e0, e1, fold = residuals[0][tested], residuals[1][tested], fold[tested]
    gain = e0**2 - e1**2
    everywhere = min(float(np.sum(gain[fold == k])) for k in dealt) > 0
    return _scored(e0, e1, paired_z(gain, problem.block), everywhere)


def choose_held_out(frame: Frame, names: list[str]) -> tuple[Mask, list[str]]:
    """Held-out rows: the named runs, else a run whose speeds the others cover, else the end of every run."""
    chosen, n = [k for k, r in enumerate(frame.runs) if r.among(names)], len(frame.runs)
    if not names and n >= FEWEST_FILES:
        speed = np.abs(np.gradient(fill(frame.columns["position"], frame.run)[0]))
        order = sorted(range(n), key=lambda k: float(np.quantile(speed[frame.run == k], limits.QUICK_SHARE)))
        closed = [k for k in order[1:-1] if frame.runs[k].header.get("loop") == "closed"] or order[1:-1]
        sessions = [r.session for r in frame.runs]
        chosen = [max([k for k in closed if sessions.count(sessions[k]) > 1] or closed)]
    if names or chosen:
        return np.isin(frame.run, chosen), [frame.runs[k].name for k in chosen]
    held = np.zeros(len(frame.t), dtype=bool)
    names_out = []
    for k, r in enumerate(frame.runs):
        rows = np.flatnonzero(frame.run == k)
        cut = rows[int(limits.FITTED_SHARE * len(rows))]
        held[cut : rows[-1] + 1] = True
        names_out.append(f"{r.name} from {frame.t[cut] - frame.t[rows[0]]:.0f} s")
    return held, names_out
