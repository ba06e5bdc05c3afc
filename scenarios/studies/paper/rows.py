"""Rows of the table: what was measured at every start, median, worst, whether all holds; and its page."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from datetime import date
from pathlib import Path
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

    @property
    def starts(self) -> int:
        """From how many starts it was measured."""
        return len(self.found) + len(self.failed)

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

    @property
    def decided(self) -> str:
        """Its words and bounds, and the worst value, as two cells; why there is none."""
        limit = self.decisive
        cells = f"{limit.words} ({limit.bounds}) | {_short(self.worst(limit), limit.unit)}"
        return f"{'; '.join(self.unevaluated)} | " if self.failed else cells

    def misses(self, limit: Limit) -> int:
        """Return at how many starts a limit is missed."""
        return sum(not limit.holds(value) for value in self.values(limit.figure)) + len(self.failed)

    def _line(self, limit: Limit) -> str:
        middle, far = self.median(limit.figure), self.worst(limit)
        text = f"{limit.words} {_short(middle)}, worst {_short(far, limit.unit)} ({limit.bounds})"
        count = self.misses(limit)
        return f"{text} at {count} of {self.starts} starts" if count else text

    def lines(self, met: bool) -> list[str]:
        """What was found for each limit that is met, or missed."""
        return [self._line(limit) for limit in self.experiment.limits if self.holds(limit) is met]

    @property
    def unevaluated(self) -> list[str]:
        """Why there are no figures, of the first start without."""
        return [f"not evaluated: {why}" for why in list(self.failed.values())[:1]]

    @property
    def beside(self) -> list[str]:
        """Medians of what is printed and decides nothing."""
        medians = ((name, self.median(name), unit) for name, unit in self.experiment.beside)
        return [f"{name} {_short(value)} {unit}" for name, value, unit in medians if value == value]

    @property
    def reason(self) -> str:
        """What was found; misses first."""
        missed, met = ("; ".join(self.lines(side)) for side in (False, True))
        return ". ".join(filter(None, [f"MISS: {missed}" * bool(missed), *self.unevaluated, met]))

    def as_json(self) -> dict[str, Any]:
        """Return the row as the JSON file has it."""
        said, first = self.experiment.said, self.decisive
        return {
            "id": self.id,
            "published": said["figure"],
            "emulated": _plain(self.worst(first)),
            "unit": first.unit,
            "passed": self.passed,
            "reason": self.reason,
            **{word: said[word] for word in ("where", "quote", "bound")},
            "limits": [
                asdict(limit)
                | {"median": _plain(self.median(limit.figure)), "worst": _plain(self.worst(limit))}
                | {"missed_at": self.misses(limit), "met": self.holds(limit)}
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


def _short(value: float, unit: str = "1") -> str:
    return "none" if value != value else f"{value:.3g}" + ("" if unit == "1" else f" {unit}")


_HEAD = Path(__file__).with_name("rows.md").read_text("utf-8")


def _line(row: Row) -> str:
    said, limit = row.experiment.said, row.decisive
    verdict = "met" if row.passed else "**miss**"
    middle, far = (_short(value, limit.unit) for value in (row.median(limit.figure), row.worst(limit)))
    decides = f"{limit.words} ({limit.bounds})"
    title = f"{said['title']} ({said['where']})"
    return f"| {row.id} | {title} | {said['figure']} | {decides} | {middle} | {far} | {verdict} |"


def _figures(row: Row) -> list[str]:
    """A line for each limit, and for each figure that is only printed beside them."""
    beside = (f"no limit: {each}" for each in row.beside)
    pieces = [*row.lines(False), *row.unevaluated, *row.lines(True), *beside]
    return [f"| {row.id} | {piece} |" for piece in pieces]


def markdown(rows: Sequence[Row], plants: Sequence[str], command: str, day: date) -> str:
    """Return the results as a Markdown page, what is missed first."""
    head = "| row | experiment | published | decides (limit) | median | worst | |\n" + "|---" * 7 + "|"
    missed, met = ([row for row in rows if row.passed is passed] for passed in (False, True))
    starts = max(len(row.found) + len(row.failed) for row in rows)
    facts = {"command": command, "day": day.isoformat(), "plants": ", ".join(plants), "starts": starts}
    lines = [_HEAD.format(**facts, met=len(met), rows=len(rows))]
    for title, those in (("Missed", missed), ("Met", met)):
        lines += [f"## {title}", head, *map(_line, those), ""]
    lines += ["## Every figure", "Median, worst, and the limit in brackets.\n"]
    lines += ["| row | figure |", "|---|---|", *(line for row in rows for line in _figures(row))]
    return "\n".join(lines) + "\n"
