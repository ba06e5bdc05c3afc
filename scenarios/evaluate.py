"""Expectations against what a run left: one function per kind, in a table."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from host.rates import rate_arcsec_s
from host.sky.angles import ARCSEC_PER_RAD
from host.sky.catalogue import Star
from scenarios.model import Expectation
from scenarios.outcome import Array, Outcome
from scenarios.programme import Record

MEAN_S = 1.0
PHASE_S = 1.0
"""Boards were switched on within the same second (scenarios/network.py)."""
PIECE_S = 1800.0
"""Long windows are looked at in pieces of at most this length."""
_ROWS_PER_MEAN = round(MEAN_S / 0.01)


class Verdict(NamedTuple):
    """One line of the report."""

    name: str
    passed: bool
    value: float | None
    limit: float
    unit: str
    upper: bool
    reason: str = ""

    def as_json(self) -> dict[str, Any]:
        """The fields of `summary.json`."""
        row: dict[str, Any] = {
            "name": self.name,
            "passed": self.passed,
            "value": self.value,
            "limit": self.limit,
            "unit": self.unit,
        }
        return row | ({"reason": self.reason} if self.reason else {})


class NoData(ValueError):
    """A window in which nothing was recorded."""


def judge(outcome: Outcome) -> list[Verdict]:
    """Verdicts on all expectations, in their order; the programme itself comes first."""
    failed = [record for record in outcome.records if record.failed]
    done = sum(record.end_s is not None and not record.failed for record in outcome.records)
    reason = f"{failed[0].step.name}: {failed[0].failed}" if failed else ""
    if outcome.counters.get("interrupted"):
        reason = reason or "the run was interrupted"
    total = len(outcome.records)
    if done < total and not reason:
        reason = f"still going at the time limit of {outcome.scenario.time_limit_s:g} s"
    verdicts = [Verdict("programme completed", done == total, done, total, "steps", False, reason)]
    return verdicts + [_judge_one(outcome, each) for each in outcome.scenario.expectations]


def _judge_one(outcome: Outcome, expectation: Expectation) -> Verdict:
    measure, unit = KINDS[expectation.kind]
    try:
        value = measure(outcome, expectation.arguments)
    except NoData as error:
        return Verdict(expectation.name, False, None, expectation.limit, unit, expectation.upper, str(error))
    passed = value <= expectation.limit if expectation.upper else value >= expectation.limit
    return Verdict(expectation.name, bool(passed), value, expectation.limit, unit, expectation.upper)


def pointing_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """Telescope against the star's observed place, ″; `sky` is the angle between them."""
    parts = []
    for record, low_s, high_s in _windows(outcome, given, ("track",)):
        ra, dec = pointing_errors(outcome, record, low_s, high_s, given.get("source", "truth"))[1:]
        match given.get("axis", "sky"):
            case "ra":
                parts.append(ra)
            case "dec":
                parts.append(dec)
            case _:
                assert record.star is not None
                parts.append(np.hypot(ra * np.cos(record.star.declination_rad), dec))
    return _statistic(np.concatenate(parts), given)


def pointing_errors(
    outcome: Outcome, record: Record, low_s: float, high_s: float, source: str
) -> tuple[Array, Array, Array]:
    """Time and the error of both axes in ″ of the axis, star less telescope."""
    if record.star is None:
        raise NoData(f"step {record.step.name!r} has no target")
    star = record.star
    parts = [_pointing_piece(outcome, star, *piece, source) for piece in _pieces(low_s, high_s)]
    t, ra, dec = (np.concatenate(column) for column in zip(*parts, strict=True))
    if not len(t):
        raise NoData("nothing was recorded in the window")
    return t, ra, dec


def _pointing_piece(
    outcome: Outcome, star: Star, low_s: float, high_s: float, source: str
) -> tuple[Array, Array, Array]:
    if source == "encoder":
        rows = outcome.host(low_s, high_s)
        good = ~np.isnan(rows["ra_error_arcsec"])
        return rows["t_s"][good], rows["ra_error_arcsec"][good], rows["dec_error_arcsec"][good]
    t, hour_angle, _ = outcome.truth("ra", low_s, high_s)
    t_dec, declination, _ = outcome.truth("dec", low_s, high_s)
    count = min(len(t), len(t_dec))
    t = t[:count]
    if not count:
        return t, t, t
    star_ha, star_dec = outcome.star_places(star, t)
    off = np.remainder(star_ha - hour_angle[:count] + np.pi, 2 * np.pi) - np.pi
    return t, off * ARCSEC_PER_RAD, (star_dec - declination[:count]) * ARCSEC_PER_RAD


def tracking_rate_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """Rate of an axis less the rate it should have, ″/s."""
    parts = [
        rate_errors(outcome, record, given.get("axis", "ra"), given.get("source", "truth"), low_s, high_s)[1]
        for record, low_s, high_s in _windows(outcome, given, ("track", "set_rate"))
    ]
    return _statistic(np.concatenate(parts), given)


def rate_errors(
    outcome: Outcome, record: Record, axis: str, source: str, low_s: float, high_s: float
) -> tuple[Array, Array]:
    """Time and rate error in ″/s: `truth`, `counts_5ms` or `mean_1s`."""
    parts = [_rate_piece(outcome, record, axis, source, *piece) for piece in _pieces(low_s, high_s)]
    t, error = (np.concatenate(column) for column in zip(*parts, strict=True))
    if not len(t):
        raise NoData("nothing was recorded in the window")
    return t, error


def _pieces(low_s: float, high_s: float) -> list[tuple[float, float]]:
    """A window in pieces that a night's memory has room for."""
    count = max(1, math.ceil((high_s - low_s) / PIECE_S))
    edges = np.linspace(low_s, high_s, count + 1)
    return [
        (float(a), float(b) if b == edges[-1] else float(np.nextafter(b, a)))
        for a, b in itertools.pairwise(edges)
    ]


def _rate_piece(
    outcome: Outcome, record: Record, axis: str, source: str, low_s: float, high_s: float
) -> tuple[Array, Array]:
    if source == "truth":
        t, _, rate = outcome.truth(axis, low_s, high_s)
        measured = rate * ARCSEC_PER_RAD
    else:
        # Stamps are the board's own time, up to a second ahead: what they call low_s may have been before it.
        rows = outcome.axis_log(axis, low_s + PHASE_S, high_s)
        t, measured = rows["t"], rate_arcsec_s(1.0) * rows["velocity"]
        if source == "mean_1s":
            count = len(t) // _ROWS_PER_MEAN * _ROWS_PER_MEAN
            t = t[:count].reshape(-1, _ROWS_PER_MEAN).mean(axis=1)
            measured = measured[:count].reshape(-1, _ROWS_PER_MEAN).mean(axis=1)
    if not len(t):
        return t, t
    return t, measured - _wanted_rate(outcome, record, axis, t)


def _wanted_rate(outcome: Outcome, record: Record, axis: str, t: Array) -> Array:
    if record.step.action == "set_rate":
        if record.step.arguments["axis"] != axis:
            raise NoData(f"step {record.step.name!r} moves the other axis")
        return np.full_like(t, record.step.arguments["rate"])
    if record.star is None:
        raise NoData(f"step {record.step.name!r} has neither a target nor a rate")
    index = 0 if axis == "ra" else 1
    ahead, behind = (outcome.star_places(record.star, t + half)[index] for half in (0.5, -0.5))
    return (ahead - behind) * ARCSEC_PER_RAD


def focus_error(outcome: Outcome, given: dict[str, Any]) -> float:
    """True focus position less the commanded one, half steps."""
    from host.logs import traces

    parts = []
    for record, low_s, high_s in _windows(outcome, given, ("focus",)):
        if record.focus_goal is None:
            continue
        rows = traces.read(outcome.folder / "focus.parquet", ("true_half_steps",), low_s, high_s)
        parts.append(rows["true_half_steps"] - record.focus_goal)
    if not parts or not sum(map(len, parts)):
        raise NoData("no focus move in the window")
    return _statistic(np.concatenate(parts), given)


def _windows(
    outcome: Outcome, given: dict[str, Any], actions: tuple[str, ...]
) -> list[tuple[Record, float, float]]:
    """The windows that count: the named step, or every step with one of the actions."""
    named = given.get("during")
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


def _counter(name: str) -> Callable[[Outcome, dict[str, Any]], float]:
    return lambda outcome, _given: float(outcome.counters[name])


KINDS: dict[str, tuple[Callable[[Outcome, dict[str, Any]], float], str]] = {
    "pointing_error": (pointing_error, "arcsec"),
    "tracking_rate_error": (tracking_rate_error, "arcsec/s"),
    "focus_error": (focus_error, "half steps"),
    "bus_load": (_counter("bus_load"), "1"),
    "overruns": (_counter("overruns"), "1"),
    "error_log_entries": (_counter("error_log_entries"), "1"),
    "frame_errors": (_counter("frame_errors"), "1"),
    "steps_completed": (_counter("steps_completed"), "1"),
    "real_time_factor": (_counter("real_time_factor"), "1"),
}
