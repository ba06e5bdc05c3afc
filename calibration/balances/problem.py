"""One channel of residual as a regression: the measured column, the declared terms, and where rows belong."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.balances.candidate import Candidate
from calibration.statistics.regression import Fit, gls, told

Term = tuple[str, str, Array]
"""Name and unit of a coefficient, and its column (n,); of a nuisance that has several, (n, k)."""


@dataclass(frozen=True)
class Estimate:
    """A coefficient and its standard error, in the same unit."""

    value: float
    error: float


@dataclass(kw_only=True)
class Problem:
    """y (n,) = base (n, p) beta + effects + noise, in `unit`, every `period_s` with gaps in `valid`.

    `run`, `session`: labels per row; `held`: held-out rows; `turned`: held out session by session, while
    every row is fitted for what is told. `floor`: rms that sensors leave in y, same unit.
    """

    channel: str
    unit: str
    y: Array
    base: Array
    base_labels: list[tuple[str, str]]
    t: Array
    run: NDArray[np.int64]
    session: NDArray[np.int64]
    valid: Mask
    held: Mask
    period_s: float
    floor: float = 0.0
    ar_order: int = 8
    block_s: float = 4.0
    domains: dict[str, Array] = field(default_factory=dict)
    step: float = 0.0  # rms that an effect must take away: less is within the sensor's own steps
    resolved: tuple[Mask, float] | None = None  # rows that a sensor's coarse steps do not spoil, floor there
    base_phases: tuple[slice, ...] = ()  # columns of `base` whose phase is every run's own
    turned: Mask | None = None
    slow: bool = False  # declared terms are nuisances, fitted on all rows
    untold: float = 0.0  # of the rows held out, that are not judged as no fitted row is like them
    known: Mapping[str, float] = field(default_factory=dict)  # coefficients of terms that y is without
    fresh: Array | None = None  # columns of nuisances refitted on held-out rows (an offset per segment)

    @property
    def block(self) -> int:
        """Rows per block of the bootstrap."""
        return max(round(self.block_s / self.period_s), 4)

    @property
    def train(self) -> Mask:
        """Valid rows that may be fitted."""
        return self.valid & ~self.held if self.turned is None else self.valid

    @property
    def blocks(self) -> int:
        """Independent blocks of fitted rows."""
        return int(self.train.sum() / self.block)

    @property
    def test(self) -> Mask:
        """Valid rows that may only be looked at, in their turn."""
        return self.valid & (self.held if self.turned is None else self.turned)

    @property
    def once(self) -> Problem:
        """The same with one part held out."""
        return replace(self, turned=None)

    @property
    def turns(self) -> list[Problem]:
        """The same with every session held out in its turn."""
        out = [self.session == k for k in np.unique(self.session[self.valid])]
        return [replace(self, held=mine, turned=None) for mine in out]

    def in_turn(self) -> Problem:
        """With every session held out in its turn, on rows of which the others tell the declared terms."""
        turned = np.logical_or.reduce([part._told for part in self.turns])
        untold = 1.0 - float((turned & self.valid).sum()) / max(int(self.valid.sum()), 1)
        return replace(self, turned=turned, untold=untold)

    def told(self) -> Problem:
        """With held-out rows of which the fitted ones tell the declared terms: no others are judged."""
        here = self._told
        untold = 1.0 - float(here.sum()) / int(self.test.sum()) if self.test.any() else 0.0
        return replace(self, valid=self.valid & (~self.held | here), untold=untold)

    @property
    def _told(self) -> Mask:
        others, mine = self.base[self.train], self.base[self.test]
        own = np.zeros(self.base.shape[1], dtype=bool)
        if self.fresh is not None:  # what is fitted there anew need not be told
            own[:] = ~others.any(axis=0)
            fresh = self.fresh[self.test]
            mine = mine - fresh @ np.linalg.lstsq(fresh, mine, rcond=None)[0]
        rows = np.zeros(len(self.y), dtype=bool)
        rows[self.test] = told(others[:, ~own], mine[:, ~own])
        return rows

    def design(self, chosen: Sequence[Candidate]) -> Array:
        """Base and chosen candidates side by side."""
        return np.hstack([self.base, *[c.columns for c in chosen]])

    def phases(self, chosen: Sequence[Candidate]) -> list[slice]:
        """Columns of `design` whose phase is every run's own."""
        out, at = list(self.base_phases), self.base.shape[1]
        for c in chosen:
            out += [slice(at, at + c.width)] if c.per_run else []
            at += c.width
        return out

    def place(self, name: str) -> int:
        """Column of the base's term `name`. ValueError where the base has none."""
        return [label for label, _ in self.base_labels].index(name)

    def add(self, *terms: Term) -> None:
        """More terms of the base."""
        self.base = np.column_stack([self.base, *[x for _, _, x in terms]])
        self.base_labels = [*self.base_labels, *labels_of(terms)]

    def holding(self, fixed: Mapping[int, float]) -> Problem:
        """The problem with these columns of the base, none of which is a run's own phase, held at a value."""
        y = self.y - sum(self.base[:, k] * value for k, value in fixed.items())
        labels = [label for k, label in enumerate(self.base_labels) if k not in fixed]
        return replace(self, y=y, base=np.delete(self.base, list(fixed), axis=1), base_labels=labels)

    def fit(self, x: Array | None = None) -> Fit:
        """The fitted rows by the base, or by the columns x (n, k), under coloured noise."""
        return gls(self.y, self.base if x is None else x, self.train, self.ar_order, self.block)

    def plain_fit(self, rows: Mask) -> tuple[dict[str, float], Array]:
        """Ordinary least squares on `rows`: coefficients by name, and the residual (n,) of all rows."""
        beta = np.asarray(np.linalg.lstsq(self.base[rows], self.y[rows], rcond=None)[0], dtype=float)
        return self.by_name(beta), self.y - self.base @ beta

    def by_name(self, beta: Array) -> dict[str, float]:
        """Coefficients of the base by name, from those of a fit whose first columns it is."""
        return {n: float(b) for (n, _), b in zip(self.base_labels, beta, strict=False)}

    def named(self, fit: Fit) -> dict[str, Estimate]:
        """Likewise, with their standard errors."""
        sizes = zip(self.base_labels, fit.beta, fit.errors, strict=False)
        return {name: Estimate(float(b), float(e)) for (name, _), b, e in sizes}


def labels_of(terms: Sequence[Term]) -> list[tuple[str, str]]:
    """A name and a unit for every column."""
    return [(name, unit) for name, unit, x in terms for _ in range(1 if x.ndim == 1 else x.shape[1])]
