"""Effects chosen in one channel, fitted together beside its declared terms."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide.heldout import HeldOut, Model, compare
from calibration.decide.scan import Contender
from calibration.statistics.regression import Fit
from calibration.statistics.surrogate import Scores

NO_SCORES = Scores(np.zeros(0), 0.0, np.zeros(0))


@dataclass(frozen=True)
class Refusal:
    """A candidate that was refused, and why."""

    what: str
    why: str


@dataclass(kw_only=True)
class Selection:
    """The chosen effects, fits without (`before`) and with them, held-out errors, refusals, `looked_at`."""

    problem: Problem
    before: Fit
    after: Fit
    held: HeldOut
    chosen: list[Contender] = field(default_factory=list)
    scores: Scores = NO_SCORES
    looked_at: int = 0
    refused: list[Refusal] = field(default_factory=list)

    @classmethod
    def of(cls, problem: Problem, chosen: Sequence[Contender] = ()) -> Selection:
        """`chosen` beside the declared terms of `problem`."""
        bare = problem.fit()
        return cls(problem=problem, before=bare, after=bare, held=HeldOut()).keep(chosen)

    def keep(self, chosen: Sequence[Contender]) -> Selection:
        """The same with `chosen` as its effects, fitted and compared anew."""
        now = replace(self, chosen=list(chosen))
        now.after = self.problem.fit(now.columns) if chosen else self.before
        now.held = now.held_on(self.problem)
        return now

    def without(self, k: int, why: str = "") -> Selection:
        """The same without effect `k`, which is refused where there is a reason."""
        again = self.keep([x for j, x in enumerate(self.chosen) if j != k])
        more = [Refusal(self.chosen[k].candidate.say(), why)] if why else []
        again.refused = [*self.refused, *more]
        return again

    @property
    def worth(self) -> list[float]:
        """Share of the held-out mean square that each effect takes off beside the others."""
        whole = self.held.before**2
        # no rows held out: not a number
        return [(x.left - self.left) / whole if whole > 0 else 0.0 for x in self.each_left_out]

    @property
    def left(self) -> float:
        """Mean square of what is left on the held-out rows; NaN where they are too few."""
        return self.held.after**2

    @property
    def each_left_out(self) -> list[Selection]:
        """The selection without its first effect, without its second, and so on."""
        return [self.without(k) for k in range(len(self.chosen))]

    def put(self, k: int, other: Contender) -> Selection:
        """The same with another effect in the place of `k`."""
        return self.keep([other if j == k else x for j, x in enumerate(self.chosen)])

    def on(self, problem: Problem) -> Selection:
        """The same effects fitted and compared on `problem`: other rows, or other declared terms."""
        return replace(self, problem=problem, before=problem.fit()).keep(self.chosen)

    def held_on(self, problem: Problem) -> HeldOut:
        """Its two fits compared on the held-out rows of `problem`."""
        return compare(problem, self.bare, self.model, self.after.whitener)

    @property
    def candidates(self) -> list[Candidate]:
        """The chosen effects as they were offered, nonlinear parameters refined."""
        return [x.candidate for x in self.chosen]

    @property
    def columns(self) -> Array:
        """(n, p): declared terms and chosen effects side by side."""
        return self.problem.design(self.candidates)

    @property
    def model(self) -> Model:
        """Declared terms and chosen effects."""
        phases = self.problem.phases(self.candidates)
        return Model(x=self.columns, beta=self.after.beta, phases=phases)

    @property
    def bare(self) -> Model:
        """The declared terms alone."""
        p = self.problem
        return Model(x=p.base, beta=self.before.beta, phases=p.base_phases)

    @property
    def statistic(self) -> float:
        """The largest score of all candidates."""
        return float(self.scores.value.max(initial=0.0))

    def at(self, k: int) -> slice:
        """Columns of the chosen effect `k` in the joint fit."""
        begin = self.problem.base.shape[1] + sum(c.width for c in self.candidates[:k])
        return slice(begin, begin + self.chosen[k].candidate.width)

    def sizes(self, k: int) -> Array:
        """Coefficients (width,) of the chosen effect `k` in the joint fit."""
        return self.after.beta[self.at(k)]

    def covariance(self, k: int) -> Array:
        """(width, width): theirs."""
        return self.after.covariance[self.at(k), self.at(k)]

    @property
    def fitted(self) -> list[tuple[Candidate, Array]]:
        """Every chosen effect with its coefficients."""
        return [(c, self.sizes(k)) for k, c in enumerate(self.candidates)]

    def effect(self, k: int) -> Array:
        """(n,): what the chosen effect `k` adds, in the channel's unit."""
        return np.asarray(self.chosen[k].candidate.columns @ self.sizes(k))

    @property
    def fitted_square(self) -> float:
        """Mean square of what is left on the fitted rows."""
        return float(np.mean(self.after.residual[self.problem.train] ** 2))

    def residual(self) -> Array:
        """(n,), with the fresh nuisances and phases of the held-out rows there."""
        e, test = self.problem.y - self.columns @ self.after.beta, self.problem.test
        e[test] = self.model.left_out(self.problem)
        return np.asarray(e)
