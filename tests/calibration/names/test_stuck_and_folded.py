"""Edges of columns that fold, stick or repeat, and of a log's numbers of columns."""

import numpy as np
import pytest

from calibration.names import channel_delay, damaged_tooth, log_wrap, sample_loss
from calibration.names.unknown_bits import _hidden, repair_stuck_bit
from tests.calibration.names.test_column_faults import COUNT, PATH, PERIOD_S, ROWS, run
from tests.calibration.names.test_rows_and_stamps import frame


def test_columns_of_a_log_have_the_plant_s_numbers() -> None:
    """effort, position, velocity, currents, tachometers."""
    assert channel_delay.COLUMNS == {
        "effort": 0, "position": 1, "velocity": 2, "current": 3, "adc_a": 3, "adc_b": 3, "tachometers": 4,
        "tach_a": 4, "tach_b": 4,
    }  # fmt: skip
    assert damaged_tooth.WIDTHS == (0.006, 0.0085, 0.012, 0.018, 0.027, 0.04, 0.06, 0.085)
    assert channel_delay.against_position("aux", 0.0) == "the aux column is early against the position"


@pytest.mark.parametrize("rate", [3, 5])
def test_a_bit_is_put_back_along_a_motion_that_changes(rate: int) -> None:
    """Quicker and quicker: the roller's mean of two rows is the step between them."""
    steps = rate + np.arange(ROWS) // 100
    true = np.cumsum(steps)
    words = true & ~(1 << 8)
    velocity = {"velocity": steps * COUNT / PERIOD_S}
    log = run(words.astype(float), columns=velocity)
    assert repair_stuck_bit(log) is not None
    assert log.columns["position"] / COUNT == pytest.approx(true.astype(float), abs=1e-6)
    missing = {"velocity": np.where(np.arange(ROWS) % 7 == 3, np.nan, velocity["velocity"])}
    assert repair_stuck_bit(run(words.astype(float), columns=missing)) is not None
    table = run(words.astype(float))
    assert repair_stuck_bit(table) is None
    table.raw.clear()
    assert repair_stuck_bit(table) is None


def test_the_cheapest_path_says_what_each_row_lacks() -> None:
    x = np.array([0.0, 3.0, 6.0, 1.0, 4.0, 7.0, 18.0])  # by threes, without the eights
    moved = np.full(6, 3.0)
    assert _hidden(x, moved, 8.0).tolist() == [0.0, 0.0, 0.0, 8.0, 8.0, 8.0, 0.0]


def test_two_words_are_a_column_and_one_is_none() -> None:
    assert repair_stuck_bit(run(np.array([5.0]), columns={"velocity": np.zeros(1)})) is None
    assert repair_stuck_bit(run(np.array([5.0, 9.0]), columns={"velocity": np.zeros(2)})) is None


@pytest.mark.parametrize(("slope", "wraps"), [(300.0, True), (700.0, False)])
def test_a_jump_is_two_hundred_usual_steps(slope: float, wraps: bool) -> None:
    """Of 2^17 counts: more than 300 * 200, less than 700 * 200."""
    found = log_wrap.repair_wraps(run((slope * np.arange(ROWS)) % 2**17))
    assert (found is not None) == wraps


def test_a_velocity_explains_what_the_position_moved() -> None:
    quick = {"velocity": np.full(ROWS, 300.0 * COUNT / PERIOD_S)}
    log = run(PATH % 2**17, columns=quick)
    assert log_wrap.repair_wraps(log) is not None
    assert np.diff(log.columns["position"] / COUNT) == pytest.approx(np.full(ROWS - 1, 300.0))


def test_a_column_that_stops_is_no_number_there() -> None:
    """A velocity at 127 counts is one of 8 bits that stops; a current has no lower end."""
    rng = np.random.default_rng(1)
    effort = np.repeat(rng.uniform(-1, 1, 50), 20)
    x = np.clip(np.round(300 * effort + rng.normal(0, 20, ROWS)), -128, 127)
    log = run(PATH, raw={"velocity": x, "effort": effort}, columns={"velocity": 0.1 * x})
    found = log_wrap._other_wraps(log)
    assert found is not None and found.note == "log: velocity stops at 127 counts"
    assert {k: p.value for k, p in found.parameters.items()} == {"column": 2.0, "bits": 8.0, "mode": 1.0}
    assert np.array_equal(np.isnan(log.columns["velocity"]), np.abs(x + 0.5) == 127.5)
    current = np.clip(np.round(500 + 300 * effort + rng.normal(0, 20, ROWS)), 300, 511)
    log = run(PATH, raw={"adc_a": current, "effort": effort}, columns={"current_a": 0.01 * current})
    found = log_wrap._other_wraps(log)
    assert found is not None and found.parameters["bits"].value == 9.0
    assert np.array_equal(np.isnan(log.columns["current_a"]), current == 511)


def test_an_unsigned_column_folds_at_ten_bits_at_most() -> None:
    saw = np.arange(3000.0) % 1024
    assert log_wrap._folds(saw, 10) == (0, 0.0) and log_wrap._folds(saw, 11) == (1024, 2.0)
    assert log_wrap._folds(np.arange(1500.0) % 512, 17) == (512, 2.0)


def repeated(rows: int, quick: float) -> float:
    """Rows that are taken out of a motion of `quick` rad a row that stands for `rows` rows, five times."""
    x = quick * np.arange(1000.0)
    for at in (150, 300, 450, 600, 750):
        x[at : at + rows] = x[at - 1]
    log = frame(x)
    sample_loss.stamps(log)
    return float(np.isnan(log.columns["position"]).sum())


@pytest.mark.parametrize(
    ("rows", "quick", "lost"), [(1, 5e-7, 5), (1, 3e-7, 0), (4, 3e-7, 0), (5, 3e-7, 25), (5, 3e-8, 0)]
)
def test_one_row_without_motion_is_chance_in_a_slow_one(rows: int, quick: float, lost: float) -> None:
    """Four ten-millionths of a radian a row; five rows in any motion."""
    assert repeated(rows, quick) == lost


def test_an_axis_that_comes_to_rest_repeats_nothing() -> None:
    last = 1e-6 * 499
    x = np.concatenate([1e-6 * np.arange(500.0), np.full(8, last), last + 1e-9 * np.arange(500.0)])
    assert sample_loss.stamps(frame(x)) is None


def test_a_leap_that_the_velocity_has_is_no_wrap() -> None:
    """An axis at rest but for three rows, in which both encoders see 2^17 counts."""
    steps = np.where(np.isin(np.arange(ROWS), (200, 500, 800)), 2.0**17, 0.0)
    seen = {"velocity": steps * COUNT / PERIOD_S}
    assert log_wrap.repair_wraps(run(np.cumsum(steps), columns=seen)) is None
    assert log_wrap.repair_wraps(run(np.cumsum(steps))) is not None


def test_rows_that_stand_at_the_log_s_end_may_be_rest() -> None:
    x = 1e-6 * np.minimum(np.arange(1000.0), 993.0)
    log = frame(x)
    assert sample_loss.stamps(log) is None and not np.isnan(log.columns["position"]).any()
