"""A named effect with everything the report says about it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field, replace

import numpy as np

UNKNOWN = "unknown"  # the name of an effect that has none
NORMAL = 1.96  # standard errors of a normal law's 95 % interval. arithmetic


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


def normal(value: float, error: float, unit: str, reach: float = NORMAL) -> Parameter:
    """An estimate and its 95 % interval, `reach` of its standard errors."""
    return Parameter(value, unit, value - reach * error, value + reach * error)


def deviation(sigma: float, rows: float, unit: str) -> Parameter:
    """A standard deviation with what independent Gaussian `rows` leave open of it."""
    return normal(sigma, sigma / float(np.sqrt(2 * rows)), unit)


@dataclass(frozen=True)
class Curve:
    """A function found in data: what it adds, in `unit`, over a signal of the plant; 95 % half-widths."""

    domain: str
    unit: str
    x: tuple[float, ...]
    y: tuple[float, ...]
    half: tuple[float, ...]


@dataclass(frozen=True)
class Finding:
    """One effect; `evidence` is -log10 p on training rows, `share` the held-out mean square it takes away."""

    name: str
    channel: str
    domain: str
    _: KW_ONLY
    stage: str | None = None
    harmonic: int | None = None
    order: float | None = None
    frequency: float | None = None
    equivalent: Sequence[str] = ()
    parameters: Mapping[str, Parameter] = field(default_factory=dict)
    evidence: float = 0.0
    share: float = 0.0
    note: str = ""
    curve: Curve | None = None

    @property
    def of_column(self) -> bool:
        """Whether it is a column's or a clock's fault that takes nothing off a response's error."""
        return self.channel == "S" and self.domain == "clock" and self.share == 0.0

    def noted(self, note: str) -> Finding:
        """With a further note behind its own."""
        return replace(self, note=f"{self.note}; {note}".lstrip("; "))

    def having(self, **parameters: Parameter) -> Finding:
        """With other parameters, or more."""
        return replace(self, parameters={**self.parameters, **parameters})

    @property
    def key(self) -> tuple[str, str | None, int | None]:
        """Name and place."""
        return (self.name, self.stage, self.harmonic)


def of_columns(
    name: str, parameters: Mapping[str, Parameter], evidence: float, share: float = 1.0, note: str = ""
) -> Finding:
    """A fault of columns or clocks, which is settled before any balance."""
    return Finding(name, "S", "clock", parameters=parameters, evidence=evidence, share=share, note=note)
