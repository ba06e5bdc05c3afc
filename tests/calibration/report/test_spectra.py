"""Amplitudes of a residual over orders and over periods: of known lines, on the fitted rows alone."""

import numpy as np
import pytest

from calibration.look.looked import Spectrum
from calibration.report.plots import _over_orders, _over_periods, plain_ticks
from tests.calibration.report.drawn import PERIOD_S, effect, problem, selection

N = 2000
TURNS = np.linspace(0.0, 40.0, N)


def orders(
    e: np.ndarray, stages: dict[str, float], held: int = 0, *found: float
) -> tuple[np.ndarray, np.ndarray]:
    p = problem(e, held)
    lines = [effect(np.ones(N), kind="line", order=order) for order in found]
    s = selection(p, *lines, effect(np.ones(N), order=90.0))
    return _over_orders(s, Spectrum(turns=TURNS, stages=stages, label=""), e)


def test_a_line_has_its_amplitude_at_its_order() -> None:
    x, y = orders(3.0 * np.cos(2 * np.pi * 5.0 * TURNS), {"wheel": 5.0})
    assert x[np.argmax(y)] == pytest.approx(5.0, rel=0.01) and y.max() == pytest.approx(3.0, rel=0.02)
    assert np.all(np.diff(x) > 0) and x[0] == pytest.approx(1 / 40.0, rel=0.3)


def test_rows_that_are_held_out_do_not_count() -> None:
    e = 3.0 * np.cos(2 * np.pi * 5.0 * TURNS)
    e[-500:] = 100.0
    x, y = orders(e, {"wheel": 5.0}, 500)
    assert x[np.argmax(y)] == pytest.approx(5.0, rel=0.01) and y.max() == pytest.approx(3.0, rel=0.03)


@pytest.mark.parametrize(
    ("stages", "found", "top"),
    [
        ({"wheel": 5.0}, [], 6.5),
        ({"wheel": 5.0}, [8.0], 10.4),
        ({}, [8.0], 10.4),
        ({}, [], 0.5 * N / 40.0),  # two rows per turn at least
        ({"wheel": 80.0}, [], 0.5 * N / 40.0),
    ],
)
def test_orders_reach_beyond_the_last_part_or_line(
    stages: dict[str, float], found: list[float], top: float
) -> None:
    x, _ = orders(np.cos(TURNS), stages, 0, *found)
    assert 0.98 * top < x[-1] <= top


def test_without_parts_a_hundred_orders_are_drawn() -> None:
    s = selection(problem(np.cos(TURNS)))
    x, _ = _over_orders(s, Spectrum(turns=TURNS / 20, stages={}, label=""), np.cos(TURNS))
    assert 98.0 < x[-1] <= 100.0
    still = _over_orders(s, Spectrum(turns=np.zeros(N), stages={}, label=""), np.cos(TURNS))
    assert len(still[0]) == len(still[1]) == 0


def periods(
    e: np.ndarray, run: np.ndarray, turns: np.ndarray, held: int = 0
) -> tuple[np.ndarray, np.ndarray]:
    p = problem(e, held, run=run)
    return _over_periods(selection(p), Spectrum(turns=turns, stages={}, label="", periods=True), e)


def test_sections_are_averaged_by_their_rows() -> None:
    t = PERIOD_S * np.arange(400.0)
    run = np.where(np.arange(400) < 300, 0, 1)
    e = np.where(run == 0, 3.0, 0.0) * np.cos(2 * np.pi * t / 10.0)
    x, y = periods(e, run, t)
    assert x[0] == pytest.approx(4 * PERIOD_S) and x[-1] == pytest.approx(299 * PERIOD_S) and len(x) == 600
    assert x[np.argmax(y)] == pytest.approx(10.0, rel=0.02)
    assert y.max() == pytest.approx(3.0 * np.sqrt(0.75), rel=0.02)
    held = periods(e, run, t, 100)[1]
    assert held.max() == pytest.approx(3.0, rel=0.02)


@pytest.mark.parametrize(("rows", "drawn"), [(10, 0), (11, 600)])
def test_a_section_lasts_ten_rows_at_least(rows: int, drawn: int) -> None:
    t = PERIOD_S * np.arange(float(rows))
    x, y = periods(np.ones(rows), np.zeros(rows, dtype=np.int64), t)
    assert len(x) == len(y) == drawn


def test_a_log_that_turns_its_slowest_stage_by_far_less_than_once_has_no_spectrum() -> None:
    at, amplitude = orders(np.cos(TURNS), {"rim": 0.01})
    assert len(at) == len(amplitude) == 0


def test_an_axis_of_orders_has_plain_numbers_and_none_between_them() -> None:
    from matplotlib.figure import Figure

    ax = Figure().subplots()
    ax.set_xscale("log")
    ax.set_xlim(1.0, 20.0)
    plain_ticks(ax)
    assert [ax.xaxis.get_major_formatter()(x) for x in (0.5, 2.0, 10.0)] == ["0.5", "2", "10"]
    assert {1.0, 2.0, 5.0, 10.0, 20.0} <= set(ax.xaxis.get_major_locator().tick_values(1.0, 20.0).round(6))
    assert ax.xaxis.get_minor_formatter()(3.0) == ""
