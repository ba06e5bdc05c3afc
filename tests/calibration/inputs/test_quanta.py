"""The step of a column at its limits, gaps of a clock, and the last digit of a text."""

from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.run import (
    Run,
    _as_multiples,
    last_digit,
    longest_step,
    quantum,
    rows_per_reading,
    signal_of,
)


def steps(*counted: tuple[float, int]) -> np.ndarray:
    return np.concatenate([np.full(count, size) for size, count in counted])


@pytest.mark.parametrize(
    ("given", "least", "found"),
    [
        (steps((1.0, 50), (2.0, 50)), 1.0, 1.0),
        (steps((1.0, 50), (2.0, 50)), 0.67, 1.0),  # the median of what is near
        (steps((1.0, 199), (2.5, 1)), 1.0, 1.0),  # one of two hundred may be off
        (steps((1.0, 198), (2.5, 2)), 1.0, None),
        (steps((1.0, 100), (3.019, 100)), 1.0, 1.0),
        (steps((1.0, 100), (3.021, 100)), 1.0, None),
        (steps((1.0, 100), (49.5, 100)), 1.0, None),
        (steps((1.0, 100), (50.5, 100)), 1.0, 1.0),  # beyond fifty its own error adds up
        (steps((1.0, 1), (70.5, 1)), 1.0, None),  # two are whole by luck
        (steps((1.0, 1), (2.0, 1), (7.5, 0)), 1.0, 1.0),
        (steps((1.0, 1), (2.0, 1), (70.5, 23)), 1.0, 1.0),  # just whole
        (steps((1.0, 3), (2.001, 1), (70.5, 22)), 1.0, 1.0),
        (steps((1.0, 1), (2.015, 1), (70.5, 22)), 1.0, None),  # about whole, as 0.03 of 24 are
        (steps((4.0, 50), (6.0, 50)), 2.0, 2.0),
    ],
)
def test_steps_are_multiples_of_the_least(given: np.ndarray, least: float, found: float | None) -> None:
    assert _as_multiples(given, least) == (None if found is None else pytest.approx(found))


def test_the_least_step_is_tried_where_a_small_one_is_not() -> None:
    x = np.cumsum(steps((1.0, 3), (4.0, 300)))
    assert quantum(x) == pytest.approx(1.0)
    assert quantum(np.array([0.0, 1.0, 3.0])) == 1.0 and quantum(np.array([0.0, 1.0])) is None
    rounded = np.concatenate([0.5 * np.arange(100.0), 0.5 * np.arange(100.0) + 1e-12])
    assert quantum(rounded) == pytest.approx(0.5)
    assert quantum(np.array([1.0, 1.0 + 1e-13, 1.0 + 2e-13])) is None


def test_a_last_digit_is_a_power_of_ten_of_all_values() -> None:
    assert [
        last_digit(np.array(x)) for x in ([0.0, 20.0], [1.0, 2.5], [0.0, 3.01], [100.0, 101.0])
    ] == pytest.approx([10.0, 0.1, 0.01, 1.0])
    assert last_digit(np.array([0.0, 1.0 + 1e-9])) == 1.0 and last_digit(np.array([0.0, np.pi])) == 0.0
    assert last_digit(np.array([0.25])) == 0.01
    fine = np.array([0.0, 0.123456, 1.0])
    assert last_digit(fine) == pytest.approx(1e-6) and last_digit(np.append(fine, 0.1234567)) == 0.0


def test_a_clock_shakes_by_three_periods_at_most_and_twenty_steps_tell_it() -> None:
    wide = np.resize([1.0, 2.0], 20)
    assert longest_step(wide, 1.0) == 5.0 and longest_step(wide[:19], 1.0) == 2.5
    assert longest_step(np.full(20, 9.0), 1.0) == 7.5 and longest_step(np.full(20, 0.1), 1.0) == 2.5
    rare = np.where(np.arange(100) < 96, 1.0, 2.0)
    assert longest_step(rare, 1.0) == 2.5


def test_a_run_begins_with_nothing_said() -> None:
    r = Run("a", Path("a"), "a", {"t": np.arange(3.0)})
    assert (r.period_s, r.start_s, r.in_order, r.notes, r.repairs) == (0.0, None, False, [], [])
    r.logged["x"] = np.zeros(0)
    assert rows_per_reading([r], "x") == 3.0 and rows_per_reading([], "x") == 1.0
    s = signal_of("x", "x", "m", np.array([1.0, np.nan]), 0)
    assert (s.low, s.high, s.missing, s.quantum) == (1.0, 1.0, 1, None)
