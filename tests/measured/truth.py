"""What a measured log is known to hold, and how an answer is judged by it."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

UNKNOWN = "unknown"
# names of a class that are written out: what a line of the table holds. ASSUMPTION
ALIKE = 2
# times the largest right value: no interval excuses more. ASSUMPTION
FAR = 1.5
RIGHT, HALF, MISSED, WRONG = "right", "half", "missed", "wrong"


@dataclass(frozen=True, kw_only=True)
class Sign:
    """An effect that may be told by one of several names; what is not given may be anything.

    size: name of a parameter, and the values that are right, which its interval must reach. order: cycles per
    position unit.
    """

    names: tuple[str, ...]
    stage: str | None = None
    harmonic: int | None = None
    domain: str | None = None
    order: tuple[float, float] | None = None
    period_s: tuple[float, float] | None = None
    size: tuple[str, float, float] | None = None

    def says(self, e: dict[str, Any]) -> bool:
        """Whether an effect of report.json is this one, by its name or by its class."""
        rate = e["frequency_Hz"]
        told = {e["name"], *e["equivalent"]}
        return (
            bool(told & set(self.names))
            and (self.stage is None or str(e["stage"]).startswith(self.stage))
            and (self.harmonic is None or e["harmonic"] in (self.harmonic, None))
            and (self.domain is None or e["domain"] == self.domain)
            and _inside(e["order"], self.order)
            and _inside(1 / rate if rate else None, self.period_s)
            and (e["name"] not in self.names or self._sized(e["parameters"]))
        )

    def _sized(self, parameters: dict[str, Any]) -> bool:
        if self.size is None:
            return True
        name, low, high = self.size
        if name not in parameters:
            return False
        told = parameters[name]
        ends = sorted(abs(told[k]) for k in ("value", "low", "high") if told[k] is not None)
        return ends[0] <= high and low <= ends[-1] and abs(told["value"]) <= FAR * high


@dataclass(frozen=True, kw_only=True)
class Answer:
    """A log's answer.

    `before`, `after`, `floor` and `own` are held-out rms in `unit`, nan where there is none. `seconds` is
    processor time.
    """

    key: str
    verdict: str
    judged: str
    why: str
    unit: str
    before: float
    after: float
    floor: float
    own: float
    seconds: float
    effects: tuple[str, ...]
    experiment: str

    @property
    def said(self) -> str:
        """The effects, or the experiment in their place."""
        return "; ".join(self.effects) or self.experiment[:160]


def _inside(value: float | None, bounds: tuple[float, float] | None) -> bool:
    return bounds is None or (value is not None and bounds[0] <= value <= bounds[1])


def judge(data: dict[str, Any], needs: Sequence[Sign], may: Sequence[Sign]) -> tuple[str, str]:
    """How an answer is, and why.

    `right`: all that is needed and nothing strange. `half`: a part of it, or something strange beside it, or
    `unknown` in its place. `wrong`: a strange name comes first, or stands alone. `missed`: neither.
    """
    effects: list[dict[str, Any]] = data["effects"]
    there = [any(s.says(e) for e in effects) for s in needs]
    strange = [e for e in effects if not any(s.says(e) for s in (*needs, *may))]
    named = [e for e in strange if e["name"] != UNKNOWN]
    why = ", ".join(
        [*(f"no {s.names[0]}" for s, t in zip(needs, there, strict=True) if not t), *map(say, named)]
    )
    if named and (not any(there) or named[0] is effects[0]):
        return WRONG, why
    if all(there) and not named:
        return RIGHT, why
    if any(there) or any(e["name"] == UNKNOWN for e in effects):
        return HALF, why
    return MISSED, why


def say(e: dict[str, Any]) -> str:
    """An effect in a few words."""
    place = f" {e['stage']}" if e["stage"] else ""
    place += f" h{e['harmonic']}" if e["harmonic"] else ""
    if not e["stage"] and e["order"]:
        place += f" order {e['order']:.4g}"
    if e["frequency_Hz"]:
        place += f" {e['frequency_Hz']:.4g} Hz"
    if e["name"] == UNKNOWN:
        place += f" over {e['domain']}"
    alike = e["equivalent"][:ALIKE]
    more = f" and {len(e['equivalent']) - ALIKE} more" if len(e["equivalent"]) > ALIKE else ""
    return e["name"] + place + (f" (or {', '.join(alike)}{more})" if alike else "")
