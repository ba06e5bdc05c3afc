"""Expectations against what a run left: one function per kind, and the table evaluate.yaml.

Schema and page are made from the table (`docs/generate/language.py`); nothing else knows a kind.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import yaml

from host.logs import traces
from scenarios.language.model import Expectation
from scenarios.language.programme import Record
from scenarios.language.units import BASE
from scenarios.run.errors import NoData, looks, pointing_errors, rate_errors
from scenarios.run.outcome import Array, Outcome


@dataclass(frozen=True)
class Verdict:
    """One line of the report. value: None: there is none, and that misses. upper: the limit is one."""

    name: str
    value: float | None
    limit: float
    unit: str
    upper: bool = False
    reason: str = ""

    @property
    def passed(self) -> bool:
        """Whether the value is on the right side of the limit."""
        if self.value is None:
            return False
        return bool(self.value <= self.limit if self.upper else self.value >= self.limit)

    def as_json(self) -> dict[str, Any]:
        """The fields of `summary.json`."""
        said = ("name", "passed", "value", "limit", "unit", *(["reason"] if self.reason else []))
        return {name: getattr(self, name) for name in said}


def judge(outcome: Outcome) -> list[Verdict]:
    """Verdicts on the programme, on a run that was cut off, on faults that never acted, and on all
    expectations, in their order."""
    failed = [record for record in outcome.records if record.failed]
    done = sum(record.end_s is not None and not record.failed for record in outcome.records)
    reason = f"{failed[0].step.name}: {failed[0].failed}" if failed else ""
    cut_off = "the run was interrupted" if outcome.counters.get("interrupted") else ""
    total = len(outcome.records)
    if done < total and not reason:
        reason = cut_off or f"still going at the time limit of {outcome.scenario.time_limit_s:g} s"
    programme = Verdict("programme completed", done, total, "steps", reason=reason)
    whole = [Verdict("run to its end", 0, 1, "times", reason=cut_off)] if cut_off else []
    silent = [
        Verdict(
            f"fault {each.name} from {each.at_ns * 1e-9:g} s on acted", 0, 1, "times",
            reason=f"{each.where}: it met nothing; may_not_act: true beside it allows that",
        )
        for each in outcome.faults if each.missing
    ]  # fmt: skip
    judged = [_judge_one(outcome, each) for each in outcome.scenario.expectations]
    return [programme, *whole, *silent, *judged]


def _judge_one(outcome: Outcome, expectation: Expectation) -> Verdict:
    kind = KINDS[expectation.kind]
    value, reason = None, ""
    try:
        value = kind.measure(outcome, expectation.arguments)
    except NoData as error:
        reason = str(error)
    return Verdict(expectation.name, value, expectation.limit, kind.unit, expectation.upper, reason)


def pointing_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """Telescope against the star's observed place, ″; `sky` is the angle between them."""
    parts = []
    for record, low_s, high_s in _windows(outcome, given, "pointing_error"):
        for star, begin_s, end_s in looks(record, low_s, high_s):
            ra, dec = pointing_errors(outcome, star, begin_s, end_s, given.get("source", "truth"))[1:]
            sky = np.hypot(ra * np.cos(star.declination_rad), dec)
            parts.append({"ra": ra, "dec": dec}.get(given.get("axis", "sky"), sky))
    return _statistic(np.concatenate(parts), given)


def tracking_rate_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """Rate of an axis less the rate it should have, ″/s."""
    parts = [
        rate_errors(outcome, record, given.get("axis", "ra"), given.get("source", "truth"), low_s, high_s)[1]
        for record, low_s, high_s in _windows(outcome, given, "tracking_rate_error")
    ]
    return _statistic(np.concatenate(parts), given)


def guiding_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """Star less its place in the first exposure, on the sky, as the guide camera saw it, ″."""
    parts = []
    for record, low_s, high_s in _windows(outcome, given, "guiding_error"):
        west, north = np.array([e.off for e in record.guided if low_s <= e.t_s <= high_s]).reshape(-1, 2).T
        parts.append({"ra": west, "dec": north}.get(given.get("axis", "sky"), np.hypot(west, north)))
    return _statistic(np.concatenate(parts), given)


def focus_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """True focus position less the commanded one, half steps."""
    parts = []
    for record, low_s, high_s in _windows(outcome, given, "focus_error"):
        if record.focus_goal is None:
            continue
        rows = traces.read(outcome.folder / "focus.parquet", ("true_half_steps",), low_s, high_s)
        parts.append(rows["true_half_steps"] - record.focus_goal)
    if not parts or not sum(map(len, parts)):
        raise NoData("no focus move in the window")
    return _statistic(np.concatenate(parts), given)


def _windows(outcome: Outcome, given: dict[str, Any], kind: str) -> list[tuple[Record, float, float]]:
    """The windows that count: the named step, or every step of the kind's actions."""
    named, actions = given.get("during"), KINDS[kind].steps
    records = [outcome.record(named)] if named else [r for r in outcome.records if r.step.action in actions]
    found = [(record, outcome.window(record, given.get("settle", 0.0))) for record in records]
    windows = [(record, *window) for record, window in found if window is not None]
    if not windows:
        raise NoData(f"{named or ' or '.join(actions)} was not reached, or is shorter than its settling time")
    return windows


def _statistic(values: Array, given: dict[str, Any]) -> float:
    if not len(values):
        raise NoData("nothing was recorded in the window")
    return float(STATISTICS[given.get("statistic", "peak")](values))


STATISTICS: dict[str, Callable[[Array], Any]] = {
    "peak": lambda values: np.max(np.abs(values)),
    "rms": lambda values: np.sqrt(np.mean(values**2)),
    "mean": lambda values: np.abs(np.mean(values)),
    "final": lambda values: abs(values[-1]),
    "p95": lambda values: np.percentile(np.abs(values), 95),
}


class Kind(NamedTuple):
    """One expectation. measure: of an outcome, given the arguments. limit: its quantity; "": a bare number.

    text: what is measured. steps: the actions whose time counts, none: the whole run. words: what a field may
    say and what that means, the default first.
    """

    measure: Callable[[Outcome, dict[str, Any]], float]
    limit: str
    text: str
    steps: tuple[str, ...] = ()
    words: Mapping[str, Mapping[str, str]] = {}

    @property
    def unit(self) -> str:
        """Base unit of value and limit."""
        return BASE[self.limit] if self.limit else "1"


def _kind(name: str, row: dict[str, Any]) -> Kind:
    """A figure that has no function of its name is a counter of the run."""
    measure = globals().get(name) or (lambda outcome, _given: float(outcome.counters[name]))
    return Kind(measure, row.get("limit", ""), row["text"], tuple(row.get("steps", ())), row.get("words", {}))


_ROWS: dict[str, Any] = yaml.safe_load(Path(__file__).with_suffix(".yaml").read_text(encoding="utf-8"))
KINDS = {name: _kind(name, row) for name, row in _ROWS.items()}
