"""Figures of merit on traces whose answer is known beforehand."""

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from host.logs.traces import Trace
from host.rates import COUNT_ARCSEC
from host.sky.catalogue import star
from host.sky.observed import observe_many
from scenarios.language.document import parse
from scenarios.language.load import convert
from scenarios.language.model import Expectation
from scenarios.language.programme import Record
from scenarios.run import errors, evaluate
from scenarios.run.outcome import Outcome

TEXT = """\
name: known
start_utc: 2026-02-10T14:00:00Z
steps:
  - name: follow
    track: {for: 100 s}
"""
OFFSET_ARCSEC, WOBBLE_ARCSEC, WOBBLE_HZ = 3.0, 0.5, 0.2


@pytest.fixture(scope="module")
def outcome(tmp_path_factory: pytest.TempPathFactory) -> Outcome:
    """A telescope that stands 3″ ahead of Pollux in hour angle and swings by 0.5″ at 0.2 Hz about that."""
    folder = tmp_path_factory.mktemp("known")
    scenario = convert(parse(TEXT, Path("known.yaml")))
    pollux = star("Pollux")
    t = np.arange(0, 100, 0.01)
    knots = np.arange(-1, 102.0)
    ha, dec, _, _ = observe_many(pollux, scenario.site, scenario.clock, knots)
    swing = WOBBLE_ARCSEC * np.sin(2 * np.pi * WOBBLE_HZ * t)
    ha = np.interp(t, knots, ha) + np.radians((OFFSET_ARCSEC + swing) / 3600)
    ha_rate = np.gradient(ha, t)
    for name, angle, rate in (("ra", ha, ha_rate), ("dec", np.interp(t, knots, dec), np.zeros_like(t))):
        trace = Trace(folder / f"truth-{name}.parquet", ("t_s", "angle", "rate"), {})
        trace.append(np.stack([t, angle + math.pi, rate], axis=1))
        trace.close()
    header = "# format: axis-log 1\n# axis: ra\n# note: made by hand\nt,setpoint,velocity\n"
    counts = np.round(np.degrees(ha_rate) * 3600 / COUNT_ARCSEC * 0.005).astype(int)
    rows = "".join(f"{a:.4f},15.0,{b}\n" for a, b in zip(t, counts, strict=True))
    (folder / "axis-ra.csv").write_text(header + rows)
    record = Record(scenario.steps[0], 0.0, 100.0, star=pollux)
    return Outcome(folder, scenario, [record], {})


@pytest.mark.parametrize("piece_s", [1800.0, 7.0])
@pytest.mark.parametrize(("axis", "statistic", "value"), [
    ("ra", "peak", OFFSET_ARCSEC + WOBBLE_ARCSEC),
    ("ra", "mean", OFFSET_ARCSEC),
    ("ra", "rms", math.sqrt(OFFSET_ARCSEC**2 + WOBBLE_ARCSEC**2 / 2)),
    ("dec", "peak", 0.0),
    ("sky", "peak", (OFFSET_ARCSEC + WOBBLE_ARCSEC) * math.cos(math.radians(28.026))),
])  # fmt: skip
def test_pointing_error_of_a_known_offset(
    outcome: Outcome, axis: str, statistic: str, value: float, piece_s: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(errors, "PIECE_S", piece_s)
    given: dict[str, Any] = {"during": "follow", "axis": axis, "statistic": statistic}
    assert evaluate.pointing_error(outcome, given) == pytest.approx(value, abs=0.002)


def test_tracking_rate_error_three_ways(outcome: Outcome) -> None:
    swing = WOBBLE_ARCSEC * 2 * math.pi * WOBBLE_HZ  # ″/s
    given = {"during": "follow", "axis": "ra", "settle": 1.0}
    true = evaluate.tracking_rate_error(outcome, {**given, "source": "truth"})
    assert true == pytest.approx(swing, rel=0.01)
    counts = evaluate.tracking_rate_error(outcome, {**given, "source": "counts_5ms"})
    quantum = COUNT_ARCSEC / 0.005  # 2.296″/s (hardware.md 2.1)
    assert quantum / 2 * 0.4 < counts < swing + quantum / 2 + 0.01
    mean = evaluate.tracking_rate_error(outcome, {**given, "source": "mean_1s"})
    assert mean < counts


def test_a_step_that_was_not_reached_has_no_value(outcome: Outcome) -> None:
    with pytest.raises(errors.NoData, match="follow was not reached"):
        evaluate.pointing_error(outcome, {"during": "follow", "settle": 200.0})


@pytest.mark.parametrize(
    ("statistic", "value"),
    [("peak", 4.0), ("rms", math.sqrt(26 / 3)), ("mean", 2 / 3), ("final", 1.0)],
)
def test_statistics_of_numbers_of_either_sign(statistic: str, value: float) -> None:
    """A mean is that of the numbers, not of their sizes, and has no sign."""
    assert evaluate.STATISTICS[statistic](np.array([3.0, -4.0, -1.0])) == pytest.approx(value)


def test_p95_is_what_one_size_in_twenty_exceeds() -> None:
    assert evaluate.STATISTICS["p95"](np.arange(-100.0, 1.0)) == pytest.approx(95.0)


@pytest.mark.parametrize(("upper", "value", "passed"), [
    (True, 2.0, True), (True, 3.0, True), (True, 4.0, False),
    (False, 2.0, False), (False, 3.0, True), (False, 4.0, True),
])  # fmt: skip
def test_a_limit_is_within_it(outcome: Outcome, upper: bool, value: float, passed: bool) -> None:
    expected = Expectation(name="lost", kind="overruns", arguments={}, limit=3.0, upper=upper, where="")
    scenario = dataclasses.replace(outcome.scenario, expectations=(expected,))
    counted = dataclasses.replace(outcome, scenario=scenario, counters={"overruns": value})
    assert evaluate.judge(counted)[-1].passed is passed
