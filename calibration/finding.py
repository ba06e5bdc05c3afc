"""A named effect with everything the report says about it."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from calibration.readers.run import Array
from calibration.statistics.tails import median_reach


@dataclass(frozen=True)
class Parameter:
    """An estimate with its 95 % interval; None where none was computed (a choice from a grid)."""

    value: float
    unit: str
    low: float | None = None
    high: float | None = None

    def times(self, factor: float) -> Parameter:
        """The same estimate in another unit or at another place; `factor` is positive."""
        low, high = (None if x is None else x * factor for x in (self.low, self.high))
        return Parameter(self.value * factor, self.unit, low, high)

    @property
    def half(self) -> float:
        """Upper half of the interval; zero where there is none."""
        return 0.0 if self.high is None else self.high - self.value

    def as_dict(self) -> dict[str, object]:
        """As in report.json."""
        return {"value": self.value, "unit": self.unit, "low": self.low, "high": self.high}


def middle(x: Array, unit: str) -> Parameter:
    """The median of several measurements (n,) of one size; without an interval where there is only one."""
    value = float(np.median(x))
    reach = median_reach(x) if len(x) > 1 else None
    return Parameter(value, unit) if reach is None else Parameter(value, unit, value - reach, value + reach)


@dataclass(frozen=True)
class Curve:
    """A function found in data: what it adds, in `unit`, over a signal of the plant; 95 % half-widths."""

    domain: str
    unit: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    half: tuple[float, ...]


@dataclass
class Finding:
    """One effect; `evidence` is -log10 p on training rows, `share` the held-out mean square it takes away."""

    name: str
    channel: str
    domain: str
    stage: str | None = None
    harmonic: int | None = None
    order: float | None = None
    frequency: float | None = None
    equivalent: list[str] = field(default_factory=list)
    parameters: dict[str, Parameter] = field(default_factory=dict)
    evidence: float = 0.0
    share: float = 0.0
    note: str = ""
    curve: Curve | None = None

    @property
    def key(self) -> tuple[str, str | None, int | None]:
        """Name and place."""
        return (self.name, self.stage, self.harmonic)
