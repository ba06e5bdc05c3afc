"""A named effect with everything the report says about it."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Parameter:
    """An estimate with its 95 % interval."""

    value: float
    unit: str
    low: float
    high: float

    def as_dict(self) -> dict[str, object]:
        """As in report.json."""
        return {"value": self.value, "unit": self.unit, "low": self.low, "high": self.high}


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
