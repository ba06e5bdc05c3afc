"""What is told of a run by its columns: its rows, its gaps, and the steps of its columns."""

from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.run import (
    Run,
    last_digit,
    longest_step,
    numbers,
    quantum,
    rows_per_reading,
    signal_of,
    step_of,
)  # fmt: skip

NAN = float("nan")


def run(t: np.ndarray, period_s: float = 0.01, **columns: np.ndarray) -> Run:
    return Run("night 1", Path("logs/one.csv"), "night", {"t": t, **columns}, period_s=period_s)


def test_rows_and_duration_are_from_the_first_to_the_last() -> None:
    assert (run(np.array([3.0, 4.0, 6.5])).rows, run(np.array([3.0, 4.0, 6.5])).duration_s) == (3, 3.5)
    assert run(np.array([3.0])).duration_s == run(np.zeros(0)).duration_s == 0.0


@pytest.mark.parametrize("name", ["night 1", "logs/one.csv", "one.csv", "one"])
def test_a_run_is_known_by_its_name_and_its_file(name: str) -> None:
    given = run(np.zeros(1))
    assert given.among([name, "another"]) and not given.among(["another", "csv", "logs"])


def test_a_gap_is_where_rows_are_missing_and_not_where_a_stamp_shakes() -> None:
    """At 10 ms with a fifth of shaking, 50 ms are missing."""
    t = 0.01 * np.arange(400) + 0.001 * np.random.default_rng(1).uniform(-1, 1, 400)
    t[200:] += 0.05
    assert run(t).gaps() == [(t[199], t[200])]
    assert run(t[:200]).gaps() == []


def test_a_clock_that_often_steps_wide_has_wider_gaps() -> None:
    """Two rows at a time: steps of 0 and 20 ms are its own."""
    steps = np.tile([0.0, 0.02], 200)
    assert longest_step(steps, 0.01) > 0.02
    assert longest_step(steps, 0.01) > longest_step(np.full(400, 0.01), 0.01) > 0.01
    few = longest_step(np.array([0.01, 5.0]), 0.01)
    assert few == longest_step(np.full(400, 0.01), 0.01)
    assert longest_step(np.full(400, 9.0), 0.01) < 9.0  # a period that is far off is no shaking


def test_numbers_and_steps_are_of_all_records() -> None:
    records = [
        run(np.arange(3.0), x=np.array([1.0, NAN, 2.0])),
        run(np.arange(1.0)),
        run(np.arange(2.0), x=np.array([5.0, 4.0])),
    ]
    assert numbers(records, "x").tolist() == [1.0, 2.0, 5.0, 4.0]
    assert len(numbers(records, "y")) == 0
    rng = np.random.default_rng(1)
    coarse = [run(np.arange(300.0), x=0.25 * rng.integers(0, 40, 300)) for _ in range(2)]
    assert step_of(coarse, "x") == pytest.approx(0.25)
    coarse[0].logged["x"] = 0.5 * rng.integers(0, 20, 300)
    coarse[1].logged["x"] = 0.5 * rng.integers(0, 20, 300)
    assert step_of(coarse, "x") == pytest.approx(0.5)  # as logged, before it was put on other stamps


def test_a_reading_that_was_put_on_other_stamps_stands_for_several_rows() -> None:
    slow, plain = run(np.arange(100.0)), run(np.arange(50.0))
    slow.logged["x"] = np.zeros(20)
    assert rows_per_reading([slow, plain], "x") == 5.0
    assert rows_per_reading([plain], "x") == 1.0
    other = run(np.arange(60.0))
    other.logged["x"] = np.zeros(20)
    assert rows_per_reading([slow, other], "x") == 4.0


@pytest.mark.parametrize("step", [1.0, 0.005, 3e-6, 7.0])
@pytest.mark.parametrize("offset", [0.0, 0.37])
def test_the_step_of_a_column_is_what_all_steps_are_multiples_of(step: float, offset: float) -> None:
    x = step * (np.random.default_rng(2).integers(-30, 30, 500) + offset)
    assert quantum(x) == pytest.approx(step, rel=1e-3)


def test_a_wide_column_has_few_steps_of_one_count() -> None:
    x = 0.5 * np.random.default_rng(3).integers(0, 3000, 800)
    assert quantum(x) == pytest.approx(0.5, rel=1e-3)


def test_what_does_not_step_has_no_quantum() -> None:
    rng = np.random.default_rng(4)
    assert quantum(rng.standard_normal(500)) is None
    assert quantum(np.full(500, 3.0)) is None and quantum(np.zeros(0)) is None
    assert quantum(np.tile([1.0, 2.0], 200)) is None  # two values: a switch


@pytest.mark.parametrize(("digit", "decimals"), [(0.01, 2), (0.1, 1), (1.0, 0), (1e-4, 4)])
def test_the_last_digit_of_a_text_is_its_power_of_ten(digit: float, decimals: int) -> None:
    x = np.round(np.random.default_rng(5).uniform(-40.0, 40.0, 300), decimals)
    assert last_digit(x) == pytest.approx(digit)


def test_numbers_finer_than_a_sensor_have_no_last_digit() -> None:
    assert last_digit(np.random.default_rng(6).uniform(-1.0, 1.0, 300)) == 0.0
    assert last_digit(np.full(5, 3.0)) == 1.0


def test_a_signal_has_range_step_and_what_is_missing() -> None:
    x = 0.1 * np.random.default_rng(7).integers(-20, 60, 400)
    x[[3, 5]] = NAN
    x[7], x[8] = -3.0, 8.0
    found = signal_of("velocity", "v", "deg/s", x, 4)
    assert (found.channel, found.column, found.unit, found.missing, found.wraps) == (
        "velocity",
        "v",
        "deg/s",
        2,
        4,
    )
    assert (found.low, found.high) == (-3.0, 8.0) and found.quantum == pytest.approx(0.1)
    empty = signal_of("velocity", "v", "deg/s", np.full(4, NAN), 0)
    assert np.isnan([empty.low, empty.high]).all() and empty.missing == 4 and empty.quantum is None
