"""What a candidate effect is to the statistics: a name and the columns it would add to a channel."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array


@dataclass(frozen=True)
class Candidate:
    """One effect at one place: `columns` (n, k) in the channel's unit per unit of each coefficient.

    `labels` names one parameter per column, or one amplitude for a whole sine pair (kind "line": columns are
    cos, sin per session). `fixed` are parameters chosen on a grid (a time constant, a time of step). Those
    that `shape` depends on are refined once the candidate is chosen.
    """

    name: str
    domain: str
    columns: Array
    labels: tuple[tuple[str, str], ...]
    kind: str = "linear"
    stage: str | None = None
    harmonic: int | None = None
    order: float | None = None
    frequency: float | None = None
    sign: int = 0  # +1: every coefficient must be positive; -1 negative; 0 free
    most: float | tuple[float, ...] = np.inf  # magnitude beyond which a coefficient (each) means nothing
    least: float = 0.0  # -log10 p below which this form is not believed; 0: as every other
    positive: tuple[int, ...] = ()  # coefficients that must be positive
    fixed: dict[str, tuple[float, str]] = field(default_factory=dict)
    twins: tuple[str, ...] = ()
    shape: Callable[[Array], Array] | None = None  # columns by the first len(steps) fixed parameters
    steps: tuple[float, ...] = ()  # a small step of each, for refinement and its interval
    within: tuple[float, float] = (-np.inf, np.inf)  # bounds of the first of them
    open: bool = False  # rows leave a stretch of such a parameter open, as edges between them: its middle
    searched: int = 0  # parameters that were searched for beside the coefficients, and must pay
    per_run: bool = False  # a pair of columns per run: the phase is every run's own
    neighbours: tuple[Candidate, ...] = ()  # lines of no stage, within the cell of this stage's order
    apart: float | None = None  # of a line that no stage has: its order, where several may be found
    note: str = ""  # of its finding, for people

    @property
    def key(self) -> tuple[str, str | None, int | None, float | None]:
        """Name and place: what a report calls the same effect."""
        return (self.name, self.stage, self.harmonic, self.apart)

    @property
    def width(self) -> int:
        """Number of columns."""
        return int(self.columns.shape[1])

    @property
    def cost(self) -> int:
        """Coefficients, and parameters that were searched for."""
        return self.width + self.searched

    @property
    def at_order(self) -> float | None:
        """Its order, cycles per turn, as refined."""
        return self.fixed["order"][0] if "order" in self.fixed else self.order

    @property
    def at_frequency(self) -> float | None:
        """Its frequency, Hz, as refined."""
        return self.fixed["frequency"][0] if "frequency" in self.fixed else self.frequency

    @property
    def repeats(self) -> float | None:
        """The order whose phase says where it is: of a line, or of a pulse once a turn."""
        return self.at_order if self.kind == "line" or "width" in self.fixed else None

    @property
    def free(self) -> list[str]:
        """Parameters that enter nonlinearly and are refined."""
        return list(self.fixed)[: len(self.steps)]

    @property
    def point(self) -> Array:
        """(len(steps),): their values."""
        return np.array([self.fixed[n][0] for n in self.free])

    @property
    def place(self) -> dict[str, float]:
        """Parameters that are not refined: which of two motors, a time constant of a grid."""
        return {n: value for n, (value, _) in self.fixed.items() if n not in self.free}

    def inside(self, p: Array) -> Array:
        """Values of them, the first within its bounds."""
        return np.concatenate([np.clip(p[:1], *self.within), p[1:]])

    def moved(self, p: Array) -> Candidate:
        """The same at other values of them, within bounds."""
        assert self.shape is not None
        p = self.inside(p)
        there = {n: (float(v), self.fixed[n][1]) for n, v in zip(self.free, p, strict=True)}
        return replace(self, columns=self.shape(p), fixed={**self.fixed, **there})

    def allowed(self, beta: Array) -> bool:
        """Whether the coefficients respect the physical sign."""
        if np.any(np.abs(beta) > self.most) or any(beta[k] <= 0 for k in self.positive):
            return False
        return self.sign == 0 or bool(np.all(np.sign(beta) * self.sign >= 0))

    def say(self) -> str:
        """The name with its place, for people."""
        place = "" if self.stage is None else f" on {self.stage}"
        return self.name + place + (f", harmonic {self.harmonic}" if self.harmonic else "")


def waves(angle: Array, harmonics: Iterable[float]) -> Array:
    """cos and sin of the angle's (n,) rad harmonics, one pair after the other."""
    return np.column_stack([g(h * angle) for h in harmonics for g in (np.cos, np.sin)])


def sine_columns(phase_cycles: Array, session: NDArray[Any]) -> Array:
    """cos and sin of a phase in cycles, a pair per session (phase is a nuisance of the session)."""
    pair = waves(2 * np.pi * phase_cycles, (1,))
    return np.hstack([np.where((session == k)[:, None], pair, 0.0) for k in np.unique(session)])


def pairs_by_section(columns: Array) -> list[list[int]]:
    """First columns of every section's sine pairs: on the same rows harmonics, on others a section."""
    ends: list[tuple[int, int]] = []
    out: list[list[int]] = []
    for k in range(0, columns.shape[1] - 1, 2):
        here = np.flatnonzero(columns[:, k : k + 2].any(axis=1))
        first, last = (int(here[0]), int(here[-1])) if len(here) else (0, 0)
        mine = next((j for j, (a, b) in enumerate(ends) if first <= b and a <= last), len(ends))
        if mine == len(ends):
            ends.append((first, last))
            out.append([])
        out[mine].append(k)
    return out


def ramp(t: Array, onset: float, length: float) -> Array:
    """0 before `onset`, 1 after `onset + length`, s; a length below 1 s is a step of 1 s."""
    return np.asarray(np.clip((t - onset) / max(length, 1.0), 0.0, 1.0))
