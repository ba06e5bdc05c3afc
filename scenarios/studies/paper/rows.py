"""A row of the table: what an experiment measured at every start, median and worst, and whether all of it
holds."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from statistics import median
from typing import Any

from scenarios.studies.paper.experiments import Experiment, Figures, Limit
from scenarios.studies.paper.starts import Start

NAN = float("nan")


@dataclass(frozen=True)
class Row:
    """found: figures by start. failed: why an experiment could not be evaluated, by start."""

    experiment: Experiment
    found: Mapping[Start, Figures]
    failed: Mapping[Start, str] = field(default_factory=dict)

    @property
    def id(self) -> str:
        """E1 to E15."""
        return self.experiment.id

    def values(self, figure: str) -> list[float]:
        """Return a figure at every start; NaN where it could not be measured."""
        return [figures.get(figure, NAN) for figures in self.found.values()]

    def holds(self, limit: Limit) -> bool:
        """Whether a limit holds at every start."""
        return bool(self.found) and not self.failed and all(map(limit.holds, self.values(limit.figure)))

    @property
    def passed(self) -> bool:
        """Whether every limit holds at every start."""
        return all(self.holds(limit) for limit in self.experiment.limits)

    def worst(self, limit: Limit) -> float:
        """Return the value that is farthest outside, or nearest to a bound."""
        return max(self.values(limit.figure), key=limit.excess, default=NAN)

    def median(self, figure: str) -> float:
        """Return the median over starts at which the figure could be measured."""
        known = [value for value in self.values(figure) if value == value]
        return median(known) if known else NAN

    @property
    def decisive(self) -> Limit:
        """The limit that is missed by most, or met by least."""
        return max(self.experiment.limits, key=lambda limit: limit.excess(self.worst(limit)))

    def misses(self, limit: Limit) -> int:
        """Return at how many starts a limit is missed."""
        return sum(not limit.holds(value) for value in self.values(limit.figure)) + len(self.failed)

    def _line(self, limit: Limit) -> str:
        unit = "" if limit.unit == "1" else f" {limit.unit}"
        middle, far = self.median(limit.figure), self.worst(limit)
        text = f"{limit.words} {_short(middle)}, worst {_short(far)}{unit} ({limit.bounds})"
        count = self.misses(limit)
        return f"{text} at {count} of {len(self.found) + len(self.failed)} starts" if count else text

    @property
    def reason(self) -> str:
        """What was found; misses first."""
        limits = self.experiment.limits
        missed = [self._line(limit) for limit in limits if not self.holds(limit)]
        met = [self._line(limit) for limit in limits if self.holds(limit)]
        parts = ["MISS: " + "; ".join(missed)] if missed else []
        if self.failed:
            parts.append(f"not evaluated: {next(iter(self.failed.values()))}")
        if met:
            parts.append("; ".join(met))
        beside = [
            f"{name} {_short(self.median(name))} {unit}"
            for name, unit in self.experiment.beside
            if self.median(name) == self.median(name)
        ]
        if beside:
            parts.append("beside (medians): " + ", ".join(beside))
        return ". ".join(parts)

    def as_json(self) -> dict[str, Any]:
        """Return the row as the JSON file has it."""
        said, first = self.experiment.said, self.decisive
        return {
            "id": self.id,
            "published": said.figure,
            "emulated": _plain(self.worst(first)),
            "unit": first.unit,
            "passed": self.passed,
            "reason": self.reason,
            "where": said.where,
            "quote": said.quote,
            "bound": said.bound,
            "limits": [
                {
                    "figure": limit.figure,
                    "unit": limit.unit,
                    "low": limit.low,
                    "high": limit.high,
                    "median": _plain(self.median(limit.figure)),
                    "worst": _plain(self.worst(limit)),
                    "missed_at": self.misses(limit),
                    "met": self.holds(limit),
                }
                for limit in self.experiment.limits
            ],
            "starts": [
                {"angle_deg": start.angle_deg, "seed": start.seed}
                | {name: _plain(value) for name, value in figures.items()}
                for start, figures in self.found.items()
            ],
        }


def _plain(value: float) -> float | None:
    return round(value, 6) if value == value else None


def _short(value: float) -> str:
    return f"{value:.3g}" if value == value else "none"
