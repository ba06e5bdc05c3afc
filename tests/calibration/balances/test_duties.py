"""Duties of both motors from the effort: the counter torque, its register, and the ticks between rows."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances import bridge, friction
from calibration.balances.bridge import counter_share, duties, register_error, shares, unlogged_errors
from calibration.balances.friction import Path, dip, steady_level
from plant.units import ARCSEC

EFFORT = np.array([0.5, -0.4, 0.0, 0.1, -0.2])


def frame(rows: int = 5, run: list[int] | None = None, **columns: np.ndarray) -> Any:
    which = np.zeros(rows, dtype=np.int64) if run is None else np.array(run)
    scale = {
        "counter_torque": 0.1, "effort_full_scale": 3000.0, "velocity_arcsec_per_count": 0.0115,
        "velocity_window_s": 0.005,
    }  # fmt: skip
    runs = [Some(scales={"counter_torque": each}) for each in (0.1, 0.25)[: which.max() + 1]]
    return Some(
        t=0.01 * np.arange(rows), run=which, runs=runs, scale=scale, get=columns.get,
        filled=lambda name: (columns[name], None),
    )  # fmt: skip


def test_the_motor_that_leads_has_all_and_the_other_the_counter_torque_of_its_run() -> None:
    given = frame(run=[0, 0, 0, 1, 1])
    assert counter_share(given).tolist() == [0.1, 0.1, 0.1, 0.25, 0.25]
    a, b = np.split(shares(given, EFFORT), 2)
    assert a.tolist() == [1.0, 0.1, 0.1, 1.0, 0.25]
    assert b.tolist() == [0.1, 1.0, 1.0, 0.25, 1.0]
    assert duties(given, EFFORT) == pytest.approx([0.5, 0.04, 0.0, 0.1, 0.05, 0.05, 0.4, 0.0, 0.025, 0.2])


@pytest.mark.parametrize(
    "register", [bridge._register, getattr(bridge._register, "py_func", bridge._register)]
)
def test_a_register_waits_for_a_whole_step(register: Any) -> None:
    """It starts at the nearest step, and moves when it is a whole one off, or afresh."""
    share = np.array([10.4, 10.9, 11.3, 11.0, 12.6, 12.6])
    fresh = np.array([1.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    held = np.array([10.0, 10.0, 11.0, 11.0, 13.0, 13.0])
    assert register(share, fresh) == pytest.approx(held - share)
    assert register(np.array([10.0, 11.0]), np.array([1.0, 0.0])) == pytest.approx([0.0, 0.0])


def test_only_the_motor_that_lags_is_off_by_its_register() -> None:
    effort = np.array([104.0, 109.0, 113.0, -126.0]) / 3000
    a, b = np.split(register_error(frame(4), effort), 2)
    assert a == pytest.approx(np.array([0.0, 0.0, 0.0, 13.0 - 12.6]) / 3000)
    assert b == pytest.approx(np.array([10.0 - 10.4, 10.0 - 10.9, 11.0 - 11.3, 0.0]) / 3000)


def test_a_run_starts_with_a_register_of_its_own() -> None:
    effort = np.array([104.0, 104.0, 46.0]) / 3000  # of a quarter 11.5
    _, b = np.split(register_error(frame(3, [0, 0, 1]), effort), 2)
    assert b[2] == pytest.approx((12.0 - 11.5) / 3000)


def test_of_the_tick_between_the_position_tells_the_motion() -> None:
    """What two ticks moved, less the logged one, beside the mean of two logged: 6 counts less in a row."""
    rows, count = 200, 0.0115 * ARCSEC
    counted = np.full(rows, 40.0)
    moved = np.full(rows, 80.0)
    moved[100] = 74.0
    given = frame(
        rows, velocity=counted * count / 0.005, setpoint=40.0 * np.ones(rows) * count / 0.005,
        position=np.cumsum(moved) * count,
    )  # fmt: skip
    slower, held = unlogged_errors(given)
    # less its own mean over a quarter of a second
    assert slower[100] == pytest.approx(6.0 * (1 - 1 / 25), rel=0.05)
    assert np.abs(np.delete(slower, np.arange(85, 116))).max() < 1e-6 and not held.any()


def test_a_set_point_that_rises_was_half_a_row_s_rise_lower_in_the_tick_between() -> None:
    rows, count = 100, 0.0115 * ARCSEC
    wanted = 40.0 + 0.5 * np.arange(rows)
    wanted[60:] += 700.0  # a leap says nothing
    wanted[80:] = np.nan  # open loop
    given = frame(
        rows, run=[0] * 50 + [1] * 50, velocity=np.zeros(rows), setpoint=wanted * count / 0.005,
        position=np.zeros(rows),
    )  # fmt: skip
    _, held = unlogged_errors(given)
    assert held[1:50] == pytest.approx(-0.25) and held[51:60] == pytest.approx(-0.25)
    assert held[0] == held[50] == held[60] == 0.0 and not held[80:].any()
    assert unlogged_errors(frame()) == []


LAW: Any = Some(stribeck_speed=2.0, stribeck_exponent=1.5, stiction_ratio=1.8, bristle_travel=0.3)


def test_friction_dips_from_rest_by_stribeck_s_law() -> None:
    speed = np.array([-4.0, 0.0, 2.0, 200.0])
    part = np.exp(-((np.abs(speed) / 2.0) ** 1.5))
    assert dip(LAW, speed) == pytest.approx(part)
    assert steady_level(LAW, speed) == pytest.approx(1.0 + 0.8 * part)


@pytest.mark.parametrize("bent", [friction._bent, getattr(friction._bent, "py_func", friction._bent)])
def test_a_bristle_bends_as_an_exponential_and_rests_where_it_is_fresh(bent: Any) -> None:
    """dz = (1 - z / g) dx, of a steady g: z = g (1 - exp(-x / g)); back again from there."""
    x = np.array([0.0, 0.1, 0.4, 0.4, 0.2, 0.5, 0.7])
    fresh = np.array([True, False, False, False, False, True, False])
    g = np.full(7, 0.3)
    top = 0.3 * (1 - np.exp(-0.4 / 0.3))
    back = -0.3 + (top + 0.3) * np.exp(-0.2 / 0.3)
    expected = [0.0, 0.3 * (1 - np.exp(-0.1 / 0.3)), top, top, back, 0.0, 0.3 * (1 - np.exp(-0.2 / 0.3))]
    assert bent(x, fresh, 0.01, g) == pytest.approx(expected)


def test_bristles_carry_the_level_of_their_own_speed() -> None:
    """Far along, steady sliding: friction is the law's level, of the row's rate."""
    x = 0.02 * np.arange(400.0)
    path = Path(position=x, fresh=np.arange(400) == 0, period_s=0.01)
    level = 1.0 + 0.8 * np.exp(-(1.0**1.5))  # 2.0 per second
    assert path.level(LAW)[1:] == pytest.approx(level)
    assert path.bristle(LAW)[-1] == pytest.approx(level, rel=1e-6)
    assert path.bristle(LAW, np.full(400, 1.3))[-1] == pytest.approx(1.3, rel=1e-6)
