"""White noise of a column from its differences, beside its rounding, its loop, and the effort."""

from typing import Any

import numpy as np
import pytest
from scipy.stats import norm

from calibration.balances.noise import QUIET_PART, ROUNDING, column_noise, position_noise, rough, row_to_row
from plant.units import ARCSEC

ROWS = 20_000
T: np.ndarray = np.arange(ROWS) / 100.0


def white(size: float, seed: int = 1, rows: int = ROWS) -> np.ndarray:
    return size * np.random.default_rng(seed).standard_normal(rows)


@pytest.mark.parametrize("order", [2, 4])
def test_noise_is_told_beside_a_smooth_motion(order: int) -> None:
    assert rough(white(0.3) + 50 * np.sin(T), order) == pytest.approx(0.3, rel=0.05)


def test_a_median_of_blocks_hears_no_transient_and_no_gap() -> None:
    x = white(0.3)
    x[500:900] += white(100.0, 2, 400)
    x[5000] = np.nan
    assert rough(x, 2) == pytest.approx(0.3, rel=0.05)


@pytest.mark.parametrize(("rows", "told"), [(202, False), (203, True), (303, True)])
def test_three_blocks_of_a_hundred_differences_tell(rows: int, told: bool) -> None:
    """The third block may be short: of 203 rows it has one second difference."""
    assert np.isfinite(rough(white(1.0)[:rows], 2)) == told


def test_blocks_are_those_of_a_hundred_rows() -> None:
    """Known squares: second differences of 0, 3, 5 in three blocks, the median 3, over root six."""
    bend = np.repeat([0.0, 3.0, 5.0], 100)
    x = np.concatenate([[0.0, 0.0], np.cumsum(np.cumsum(bend))])
    assert rough(x, 2) == pytest.approx(3.0 / np.sqrt(6.0))
    # the sum of squared binomials of fourth differences is 70
    x = np.concatenate([np.zeros(4), np.cumsum(np.cumsum(np.cumsum(np.cumsum(bend))))])
    assert rough(x, 4) == pytest.approx(3.0 / np.sqrt(70.0), rel=1e-4)


def test_what_follows_the_sensor_through_a_loop_is_no_noise() -> None:
    """A command that answers the sensor over the last five rows; a sixth is not known of."""
    sensor = white(1.0)
    gains = (2.0, -1.0, 0.5, 0.2, 1.5)
    answer = np.sum([g * np.roll(sensor, k) for k, g in enumerate(gains)], axis=0)
    told = rough(answer + white(0.01, 2), 2, sensor)
    assert told == pytest.approx(0.01, rel=0.1)
    assert rough(answer + np.roll(sensor, 5), 2, sensor) > 0.3
    short = rough(answer[:102], 2, sensor[:102])
    assert np.isnan(short)


def test_noise_from_row_to_row_needs_more_than_twenty_fourth_differences() -> None:
    x, every = white(0.2) + T**2, np.ones(ROWS, dtype=bool)
    assert row_to_row(x, every) == pytest.approx(0.2, rel=0.05)
    spoiled = x.copy()
    spoiled[100:200] = 1e9
    every[100:200] = False
    assert row_to_row(spoiled, every) == pytest.approx(0.2, rel=0.05)
    assert np.isnan(row_to_row(x[:24], np.ones(24, dtype=bool)))  # twenty
    assert np.isfinite(row_to_row(x[:25], np.ones(25, dtype=bool)))
    spike = np.zeros(109)
    spike[54] = 1.0  # squares sum up to 70
    assert row_to_row(spike, np.ones(109, dtype=bool)) == pytest.approx(1 / np.sqrt(105.0))


def test_a_position_s_noise_is_its_sensor_s_or_its_rounding() -> None:
    one = np.zeros(ROWS, dtype=np.int64)
    assert position_noise(white(0.3) + 3 * T, one) == pytest.approx(0.3, rel=0.03)
    steps = np.round(7.3 * T)  # counts
    assert position_noise(steps, one) == pytest.approx(1 / np.sqrt(12.0))
    assert position_noise(steps, one, 4.0) == pytest.approx(4 / np.sqrt(12.0))
    assert position_noise(steps, one, 0.25) == pytest.approx(1 / np.sqrt(12.0))
    assert pytest.approx(0.2887, abs=1e-4) == ROUNDING


def test_a_leap_from_file_to_file_is_no_noise() -> None:
    """Files of six rows, each of which starts elsewhere: most fourth differences would be leaps."""
    rng = np.random.default_rng(4)
    file = np.repeat(np.arange(400), 6)
    x = 1000.0 * rng.standard_normal(400)[file] + 0.1 * rng.standard_normal(2400)
    assert position_noise(x, file) == pytest.approx(0.1, rel=0.15)


def test_a_position_without_a_quantum_has_the_size_of_its_smallest_moves_as_one() -> None:
    """Between two of its readings the rows lie on a line: the fiftieth part of moves that are any."""
    x = np.cumsum(np.concatenate([np.zeros(500), np.linspace(1.0, 2.0, 1001) ** 3]))
    moves = np.linspace(1.0, 2.0, 1001) ** 3
    least = np.quantile(moves, 0.02) / np.sqrt(12.0)
    assert position_noise(x, np.zeros(1501, dtype=np.int64)) == pytest.approx(least, rel=1e-3)
    assert position_noise(np.zeros(50), np.zeros(50, dtype=np.int64)) == 0.0


SCALE = {
    "position_arcsec_per_count": 0.5, "velocity_arcsec_per_count": 0.1, "velocity_window_s": 0.005,
    "adc_A_per_count": 0.01,
}  # fmt: skip


def log(**columns: np.ndarray) -> Any:
    class Log:
        scale = SCALE

    every = {k: np.full(ROWS, np.nan) for k in ("position", "velocity", "current_a", "current_b", "effort")}
    Log.columns = {**every, **columns}  # type: ignore[attr-defined]
    Log.get = staticmethod(columns.get)  # type: ignore[attr-defined]
    return Log


def test_every_column_has_its_noise_and_at_least_its_rounding() -> None:
    found = column_noise(log(position=3 * ARCSEC * white(1.0), velocity=0 * T, effort=white(0.02)))
    assert set(found) == {"position", "velocity", "effort"}
    assert found["position"] == pytest.approx(3 * ARCSEC, rel=0.05)
    assert found["velocity"] == pytest.approx(0.1 * ARCSEC / 0.005 / np.sqrt(12))
    assert found["effort"] == pytest.approx(0.02, rel=0.05)
    assert column_noise(log(position=0 * T))["position"] == pytest.approx(0.5 * ARCSEC / np.sqrt(12))
    assert column_noise(log(effort=0 * T))["effort"] == 0.0


def test_of_a_current_what_the_effort_moves_is_no_noise() -> None:
    """Of the effort's size in this row and two before, with another share by its sign."""
    effort = 0.5 * np.sign(np.sin(T)) + white(0.05, 3)
    u = np.abs(effort)
    share = np.where(effort > 0, 1.0, 0.1)
    driven = share * (3 * u + 2 * np.roll(u, 1) - np.roll(u, 2))
    i = 5.0 + driven + white(0.04, 5)
    found = column_noise(log(current_a=i, current_b=i, effort=effort))
    assert found["current_a"] == pytest.approx(0.04, rel=0.1) and found["current_b"] == found["current_a"]


def test_of_a_current_only_what_flows_is_heard_and_disturbed_rows_are_not() -> None:
    i = 5.0 + white(0.04, 5)
    i[::37] += 3.0  # of every second difference's three rows one in twelve
    found = column_noise(log(current_a=i, effort=0 * T + 0.3))["current_a"]
    assert found == pytest.approx(0.04, rel=0.25)
    quiet = np.where(np.arange(ROWS) < ROWS // 4, 5.0 + white(0.04, 5), 0.019)
    found = column_noise(log(current_a=quiet, effort=0 * T + 0.3))["current_a"]
    assert found == pytest.approx(0.04, rel=0.05)
    none = column_noise(log(current_a=0 * T, effort=0 * T))["current_a"]
    assert none == pytest.approx(0.01 / np.sqrt(12.0))  # a count's rounding


def test_the_smaller_four_fifths_of_normal_values_have_their_known_part_of_the_mean_square() -> None:
    q = norm.ppf(0.9)
    assert pytest.approx((0.8 - 2 * q * norm.pdf(q)) / 0.8, abs=1e-4) == QUIET_PART
