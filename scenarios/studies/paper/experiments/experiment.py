"""What every row is: a sentence of the paper, figures measured at one start, the bounds they are held to."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

import yaml

from scenarios.studies.paper.starts import Benches

Figures = dict[str, float]
EVER = 1e9
ROWS = Path(__file__).with_name("rows.yaml")


@dataclass(frozen=True, kw_only=True)
class Limit:
    """Bounds of one figure, inclusive. scale: a small change of it, the unit of the search's distance."""

    figure: str
    unit: str
    low: float = -EVER
    high: float = EVER
    words: str
    scale: float = 1.0

    def holds(self, value: float) -> bool:
        """Whether a value is within the bounds; NaN never is."""
        return self.low <= value <= self.high

    def excess(self, value: float) -> float:
        """How far outside, in units of `scale`; negative inside, by the distance to the nearer bound."""
        if value != value:
            return EVER
        if self.one_sided:
            return (value - self.high) / self.scale
        return max(self.low - value, value - self.high) / self.scale

    @property
    def one_sided(self) -> bool:
        """Whether only the upper bound means anything: figures that cannot be negative."""
        return self.low <= 0.0 < self.high < EVER and self.low != -self.high

    @property
    def bounds(self) -> str:
        """The bounds as text."""
        if self.one_sided or self.high == 0.0:
            return f"≤ {self.high:g}"
        return f"≥ {self.low:g}" if self.high >= EVER else f"{self.low:g}–{self.high:g}"


@cache
def _rows() -> dict[str, dict[str, Any]]:
    found: dict[str, dict[str, Any]] = yaml.safe_load(ROWS.read_text(encoding="utf-8"))
    return found


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """One row. beside: figures that are printed and decide nothing, with unit."""

    id: str
    limits: tuple[Limit, ...]
    measure: Callable[[Benches], Figures]
    beside: tuple[tuple[str, str], ...] = ()

    @property
    def said(self) -> dict[str, Any]:
        """Its row of rows.yaml. title; where: in the paper; figure: published, in words; quote: its text;
        bound: how it is measured and why held to these limits."""
        return _rows()[self.id]


def row(
    name: str, beside: tuple[tuple[str, str], ...] = ()
) -> Callable[[Callable[[Benches], Figures]], Experiment]:
    """Makes a function the experiment of this name in rows.yaml. beside: figures whose names code makes."""
    told = _rows()[name]
    limits = tuple(Limit(**each) for each in told["limits"])
    shown = (*map(tuple, told.get("beside", ())), *beside)
    return lambda measure: Experiment(id=name, limits=limits, measure=measure, beside=shown)
