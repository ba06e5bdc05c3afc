"""Counters that wrap or stop, and bits that stick."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.run import Run
from calibration.names import log_wrap
from calibration.names.inplant import Facts
from calibration.names.unknown_bits import repair_stuck_bit
from plant.units import ARCSEC

ROWS, PERIOD_S, COUNT = 1000, 0.01, 0.5 * ARCSEC
SCALES = {"position_arcsec_per_count": 0.5, "sample_period_s": PERIOD_S, "gear_ratio": 100.0}
PATH: np.ndarray = 300.0 * np.arange(ROWS)  # counts


def run(counts: np.ndarray, **more: Any) -> Run:
    n = len(counts)
    columns = {"t": PERIOD_S * np.arange(n), "position": counts * COUNT, **more.pop("columns", {})}
    raw = {"position": counts, "effort": np.zeros(n), **more.pop("raw", {})}
    return Run("log", Path("log"), "a", columns, raw=raw, scales=dict(SCALES))


def sizes(f: Finding | None) -> dict[str, float]:
    assert f is not None
    return {name: p.value for name, p in f.parameters.items()}


@pytest.mark.parametrize("way", [1.0, -1.0])
def test_a_position_that_wraps_at_a_power_of_two_goes_on(way: float) -> None:
    log = run((way * PATH) % 2**17)
    found = log_wrap.repair_wraps(log)
    assert sizes(found) == {"column": 1.0, "bits": 17.0, "mode": 0.0} and found is not None
    times = 2 if way > 0 else 3  # backwards at once
    assert found.note == f"log: position wraps at 2^17 counts, {times} times" and found.evidence == times
    assert log.notes == ["position wraps at 2^17 counts"] and found.channel == "S"
    there = log.columns["position"] / COUNT
    assert np.diff(there) == pytest.approx(np.full(ROWS - 1, way * 300.0))
    assert there[0] == pytest.approx(0.0, abs=1e-6)


def test_a_leap_of_no_power_of_two_beside_a_gap_or_too_small_is_no_wrap() -> None:
    leapt = PATH + np.where(PATH > 1e5, 1.5 * 2**17, 0.0)
    assert log_wrap.repair_wraps(run(leapt)) is None
    small = PATH + np.where(PATH > 1e5, 2.0**15, 0.0)
    assert log_wrap.repair_wraps(run(small)) is None
    wrapped = PATH % 2**17
    gap = {"t": PERIOD_S * np.arange(ROWS) + np.cumsum(np.abs(np.diff(wrapped, prepend=0.0)) > 1e4)}
    assert log_wrap.repair_wraps(run(wrapped, columns=gap)) is None
    assert log_wrap.repair_wraps(run(np.array([0.0, 2.0**17] * 5))) is None  # nine steps
    driven = {"velocity": np.full(ROWS, 2.0**17 * COUNT / PERIOD_S)}
    assert log_wrap.repair_wraps(run(2.0**17 * np.arange(ROWS), columns=driven)) is None


def test_a_velocity_that_folds_is_unfolded_along_the_position() -> None:
    rate = np.round(np.linspace(0, 900.0, ROWS))  # counts per row
    log = run(np.cumsum(rate), raw={"velocity": rate % 256}, columns={"velocity": (rate % 256) * 0.1})
    log.columns["position"] = np.cumsum(rate) * 0.1 * PERIOD_S
    found = log_wrap._other_wraps(log)
    assert sizes(found) == {"column": 2.0, "bits": 8.0, "mode": 0.0} and found is not None
    assert (found.note, found.evidence) == ("log: velocity folds at 256 counts", 3.0)
    assert log.columns["velocity"] == pytest.approx(0.1 * rate)
    assert log_wrap._other_wraps(run(PATH, raw={"velocity": rate[:99] % 256})) is None


def test_folds_are_steps_of_a_power_of_two_over_a_range_as_large() -> None:
    saw = np.arange(2000.0) % 512
    assert log_wrap._folds(saw, 17) == (512, 3.0)
    assert log_wrap._folds(saw[:900], 17) == (0, 0.0)  # once
    assert log_wrap._folds(saw, 9) == (0, 0.0) and log_wrap._folds(saw, 10) == (512, 3.0)
    assert log_wrap._folds(np.append(saw, 600.0), 17) == (0, 0.0)
    assert log_wrap._folds(np.arange(2000.0) % 64, 17) == (0, 0.0)
    assert log_wrap._folds(100 * np.arange(2000.0) % 512, 17) == (0, 0.0)  # quick motion


def test_a_column_that_piles_up_at_a_power_of_two_stops() -> None:
    rng = np.random.default_rng(1)
    effort = np.repeat(rng.uniform(-1, 1, 100), 20)
    x = np.clip(np.round(300 * effort + rng.normal(0, 20, 2000)), -128, 127)
    assert log_wrap._stops(x, "tach_a", effort) == (0, 0.0)
    end, sure = log_wrap._stops(x, "velocity", effort)
    assert end == 127 and sure > 50
    assert log_wrap._stops(np.clip(x, -100, 100), "velocity", effort) == (0, 0.0)
    assert log_wrap._stops(np.clip(x, -128, 100), "velocity", effort)[0] == -128
    current = np.clip(np.round(500 + 300 * effort + rng.normal(0, 20, 2000)), 300, 600)
    assert log_wrap._stops(current, "adc_a", effort)[0] == 600
    assert log_wrap._stops(current + 423, "adc_a", effort) == (0, 0.0)  # the converter's own end
    assert log_wrap._stops(np.zeros(2000), "velocity", effort) == (0, 0.0)


def test_a_plant_has_whole_bits() -> None:
    facts = Facts("a log")

    def made(bits: float) -> Any:
        given = {"column": Parameter(3.0, "1"), "bits": Parameter(bits, "1"), "mode": Parameter(1.0, "1")}
        return log_wrap.to_plant(Finding("log_wrap", "S", "clock", parameters=given, note="why"), facts)

    whole, part = made(10.0), made(9.3)
    assert whole.effects[0].parameters["bits"].value == 10.0 and whole.remarks == ["log_wrap: why"]
    assert part.effects[0].parameters["bits"].value == 9.0
    assert part.remarks[1] == "log_wrap: why, written as 9 bits"
    none = log_wrap.to_plant(Finding("log_wrap", "S", "clock"), facts)
    assert none.remarks == ["log_wrap: left out, the finding does not say which column wraps where"]


def stuck(bit: int, at: int) -> Run:
    """Counts that grow by three a row, one bit of which is always `at`."""
    true = 3 * np.arange(ROWS)
    words = true | (1 << bit) if at else true & ~(1 << bit)
    velocity = {"velocity": np.full(ROWS, 3 * COUNT / PERIOD_S)}
    return run(words.astype(float), columns=velocity)


@pytest.mark.parametrize("at", [0, 1])
@pytest.mark.parametrize("bit", [5, 8])
def test_a_bit_that_sticks_is_put_back_by_the_motion(bit: int, at: int) -> None:
    log = stuck(bit, at)
    found = repair_stuck_bit(log)
    assert found is not None and sizes(found) == {"bit": float(bit), "step": 0.5 * 2**bit}
    assert log.columns["position"] / COUNT == pytest.approx(3.0 * np.arange(ROWS), abs=1e-6)
    wrong = ((3 * np.arange(ROWS)) >> bit & 1) != at
    assert found.note == f"log: bit {bit} of the position is always {at}; {wrong.sum()} rows are put right"
    assert found.evidence == pytest.approx(np.log10(2) * np.abs(np.diff(wrong.astype(int))).sum())
    assert (found.channel, found.domain, found.share) == ("S", "axis_angle", 1.0)


def test_bits_below_the_resolution_above_the_range_and_tables_are_no_fault() -> None:
    velocity = {"velocity": np.full(ROWS, 4 * COUNT / PERIOD_S)}
    assert repair_stuck_bit(run(4.0 * np.arange(ROWS), columns=velocity)) is None
    assert repair_stuck_bit(run(3.0 * np.arange(ROWS), columns=velocity)) is None
    assert repair_stuck_bit(run(3.0 * np.arange(ROWS))) is None
    assert repair_stuck_bit(stuck(10, 0)) is None  # of a range of 2999
    two = stuck(5, 0)
    two.raw["position"] = (two.raw["position"].astype(int) & ~(1 << 7)).astype(float)
    assert repair_stuck_bit(two) is None
