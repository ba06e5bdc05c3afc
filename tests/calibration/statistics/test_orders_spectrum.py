"""Spectra over order: their grid, their scale, the level around a bin, and the strongest lines of one."""

import numpy as np
import pytest

from calibration.statistics.orders import around, order_spectrum, peaks, power_of_two

ROWS = 4000
TURNS = 8.0
ANGLE = 3.0 + np.linspace(0.0, TURNS, ROWS)  # the travel need not begin at nothing
ONES = np.ones(ROWS)


def noise(seed: int, rows: int = ROWS) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(rows)


@pytest.mark.parametrize(("least", "power"), [(1, 1), (2, 2), (3, 4), (16, 16), (17, 32), (1025, 2048)])
def test_a_transform_has_the_next_power_of_two(least: int, power: int) -> None:
    assert power_of_two(least) == power


@pytest.mark.parametrize("fine", [1, 4, 16])
@pytest.mark.parametrize("top", [2.0, 37.0, 120.0])
def test_orders_run_from_one_cycle_per_travel_to_the_top_and_finely(top: float, fine: int) -> None:
    orders, power = order_spectrum(noise(1), ANGLE, ONES, top, fine)
    step = np.diff(orders)
    assert len(orders) == len(power) and step == pytest.approx(step[0])
    assert step[0] <= 1 / (fine * TURNS) * (1 + 1e-9)
    assert 1 / TURNS <= orders[0] < 1 / TURNS + step[0] * (1 + 1e-9)
    assert top - step[0] < orders[-1] <= top


def test_an_order_is_told_finer_than_the_travel_resolves_without_being_asked() -> None:
    orders, _ = order_spectrum(noise(1), ANGLE, ONES, 60.0)
    assert np.diff(orders)[0] <= 1 / (4 * TURNS)


def test_both_ends_of_the_orders_belong_to_them() -> None:
    """With few cycles the grid is quarters of one, so that one cycle and the top are on it."""
    orders, _ = order_spectrum(noise(1), np.linspace(0.0, 1.0, ROWS), ONES, 10.0)
    assert orders == pytest.approx(np.arange(1.0, 10.1, 0.25))


@pytest.mark.parametrize("order", [2.0, 5.0, 11.25])
def test_a_line_alone_has_half_as_much_power_as_there_are_rows(order: float) -> None:
    """|sum cos^2|^2 = (n / 2)^2, over the mean square 1 / 2 and n rows: n / 2."""
    e = 3.0 * np.cos(2 * np.pi * order * ANGLE + 1.0)
    orders, power = order_spectrum(e, ANGLE, ONES, 240.0)
    at = int(np.argmax(power))
    assert orders[at] == pytest.approx(order, abs=0.6 * (orders[1] - orders[0]))
    assert power[at] == pytest.approx(ROWS / 2, rel=0.03)


@pytest.mark.parametrize("constant", [True, False])
def test_white_noise_has_power_one_whatever_its_size_and_weight(constant: bool) -> None:
    weight = ONES if constant else np.linspace(-3.0, 2.0, ROWS)
    means = [np.mean(order_spectrum(7.0 * noise(seed), ANGLE, weight, 200.0)[1]) for seed in range(20)]
    assert np.mean(means) == pytest.approx(1.0, abs=0.05)  # the mean of 20 times 1600 cells: 0.006


def test_where_nothing_is_left_no_order_has_power() -> None:
    orders, power = order_spectrum(0.0 * ONES, ANGLE, ONES, 60.0)
    assert len(orders) and not power.any()


def test_a_drive_that_rests_and_a_few_rows_have_no_spectrum() -> None:
    rest = order_spectrum(noise(1), np.full(ROWS, 2.0), ONES, 60.0)
    few = order_spectrum(noise(1, 19), ANGLE[:19], ONES[:19], 60.0)
    assert all(len(part) == 0 for part in (*rest, *few))
    assert len(order_spectrum(noise(1, 20), np.linspace(0, 4, 20), np.ones(20), 2.0)[0])


def test_the_strongest_orders_come_first_and_keep_their_distance() -> None:
    orders = np.arange(10.0)
    power = np.array([0.0, 3.0, 9.0, 8.0, 7.0, 0.0, 5.0, 0.0, 0.0, 4.0])
    assert peaks(orders, power, 3, 1.0).tolist() == [2.0, 3.0, 4.0]
    assert peaks(orders, power, 3, 2.0).tolist() == [2.0, 4.0, 6.0]
    assert peaks(orders, power, 9, 3.0).tolist() == [2.0, 6.0, 9.0]
    assert peaks(orders, power, 2, 3.0).tolist() == [2.0, 6.0]
    assert power[2] == 9.0  # the caller's is as it was
    assert peaks(orders, power / 100, 2, 3.0).tolist() == [2.0, 6.0]


def test_where_there_is_no_power_there_is_no_peak() -> None:
    assert len(peaks(np.arange(4.0), np.zeros(4), 3, 1.0)) == 0
    assert len(peaks(np.zeros(0), np.zeros(0), 3, 1.0)) == 0


@pytest.mark.parametrize("count", [48, 50, 53])
def test_the_level_around_is_the_mean_of_noise_of_that_median(count: int) -> None:
    """An exponential's median is ln 2 of its mean."""
    assert around(np.full(count, 3.0), 8) == pytest.approx(np.full(count, 3.0 / np.log(2)))
    drawn = np.random.default_rng(2).exponential(5.0, 100 * count)
    assert np.mean(around(drawn, 100)) == pytest.approx(5.0, rel=0.1)


def test_the_level_follows_its_neighbourhood_and_no_single_line() -> None:
    power = np.repeat([1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.0], 9)
    power[31] = 1e9
    expected = np.repeat([1.0, 1.0, 2.0, 2.0, 2.0, 1.0, 1.0], 9)  # with those beside it: (1 + 1 + 4) / 3
    assert around(power, 9) * np.log(2) == pytest.approx(expected)
