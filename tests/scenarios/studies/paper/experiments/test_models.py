"""E9 and E10 against closed formulas: equation (6) from rest, the tuning rules, how figures are made."""

from dataclasses import replace
from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.paper.experiments import models
from scenarios.studies.paper.experiments.identify import FirstOrder
from scenarios.studies.paper.experiments.models import (
    RULES,
    LinearAxis,
    equation_6,
    factor,
    linear_axis,
    simulate_loop,
    tuning_rules,
)
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, GEAR_RATIO
from tests.scenarios.studies.paper.bench import LOW, StubBench, benches, log_of, near

HALVES = LinearAxis(
    torque_constant=1.0, resistance=2.0, inductance=2e-4 / log(2.0), inertia=1e6, viscous=0.0,
    stiction=0.0, voltage=24.0, drive=0.5,
)  # fmt: skip
"""The current's distance to its goal halves in each 0.1 ms; the axis hardly turns."""
STEPS = 3000


def test_the_axis_of_a_plant_is_reflected_to_the_shaft() -> None:
    axis, motor, square = LOW.axes.ra, LOW.axes.ra.motor, GEAR_RATIO**2
    assert linear_axis(LOW) == LinearAxis(
        torque_constant=motor.torque_constant.si,
        resistance=motor.loop,
        inductance=motor.inductance.si,
        inertia=near(axis.inertia.si / square + 2 * motor.rotor_inertia.si),
        viscous=near(axis.friction.viscous.si / square + 2 * motor.drag.si),
        stiction=near(axis.friction.stiction.si / GEAR_RATIO),
        voltage=24.0,
        drive=near(0.9),
    )


def test_the_set_point_rises_by_36_arcsec_s_in_5_ms_up_to_600() -> None:
    """Of a motor without a supply only the controller shows: Kp times the set point in counts."""
    still = replace(HALVES, voltage=0.0)
    rate, effort = simulate_loop(still, (2.0, 0.0), STEPS, 0.15)
    wanted = np.minimum(600.0, 36.0 * np.arange(1, 31))
    assert not rate.any()
    assert effort == pytest.approx(2.0 * wanted / COUNT_RATE)
    _, half = simulate_loop(still, (2.0, 0.0), STEPS // 2, 0.15)
    assert half == pytest.approx(2.0 * effort)  # steps of a bridge that has half as many


def test_integral_action_adds_every_error_and_the_duty_ends_at_the_supply() -> None:
    still = replace(HALVES, voltage=0.0)
    errors = np.minimum(600.0, 36.0 * np.arange(1, 31)) / COUNT_RATE
    _, effort = simulate_loop(still, (0.0, 0.5), STEPS, 0.15)
    assert effort == pytest.approx(0.5 * np.cumsum(errors))
    for sign in (1.0, -1.0):
        _, full = simulate_loop(still, (0.0, sign * 1000.0), STEPS, 0.15)
        assert full == pytest.approx(sign * 3000.0)


def test_the_current_lags_and_the_effort_acts_half_a_period_late() -> None:
    """An effort E stands after 25 of 50 steps of the second period; its goal: (E/3000 24 0.5 - held) / 2."""
    held_v = 0.25 * 2.0 / 1.0  # stiction, N m, times R / K
    rate, effort = simulate_loop(replace(HALVES, stiction=0.25), (30.0, 0.0), STEPS, 0.01)
    goal = (effort[0] / 3000.0 * 24.0 * 0.5 - held_v) / 2.0
    current = goal * (1.0 - 0.5 ** np.arange(1, 26))
    speed = np.cumsum(current) * 1e-4 / 1e6  # rad/s of the shaft, after each step
    expected = speed.sum() / 50 / GEAR_RATIO / ARCSEC
    assert rate[0] == 0.0
    assert rate[1] == pytest.approx(expected, rel=1e-9)


def test_it_settles_where_the_statics_say() -> None:
    axis = replace(HALVES, inertia=1e-3, viscous=0.01, stiction=0.02, torque_constant=0.05, drive=0.9)
    rate, effort = simulate_loop(axis, (0.5, 0.02), STEPS, 2.0)
    shaft = 600.0 * ARCSEC * GEAR_RATIO
    volt = (0.02 + 0.01 * shaft) * 2.0 / 0.05 + 0.05 * shaft
    assert len(rate) == 400
    assert rate[-1] == pytest.approx(600.0, rel=1e-5)
    assert effort[-1] == pytest.approx(volt / 24.0 / 0.9 * 3000.0, rel=1e-5)


def test_stiction_holds_but_never_pushes_back() -> None:
    """A controller that overshoots brakes the axis; at rest it stays there until the effort is enough."""
    axis = replace(HALVES, inertia=1e-4, stiction=0.1, torque_constant=0.1)
    rate, effort = simulate_loop(axis, (30.0, 0.0), STEPS, 0.3)
    assert rate.min() == 0.0 and rate.max() > 600.0 and effort.min() < 0.0
    weak, _ = simulate_loop(replace(axis, stiction=1.0), (1.0, 0.0), STEPS, 0.3)
    assert not weak.any()  # 1 N m asks for 20 V


def test_an_axis_without_friction_coasts_through_a_low_speed() -> None:
    """Its effort falls to nothing at the set point: neither speed nor voltage below one is standing still."""
    axis = replace(HALVES, inertia=3.0, torque_constant=0.1, stiction=0.001)
    rate, effort = simulate_loop(axis, (0.3, 0.0), STEPS, 0.2)
    assert np.all(np.diff(rate[2:]) > 0.0)
    shaft = rate * ARCSEC * GEAR_RATIO
    assert shaft[-1] < 1.0 and effort[-1] / 3000.0 * 12.0 < 1.0


M = FirstOrder(gain=2.0, lag_s=0.3, dead_s=0.1)
HANDBOOK = {
    "Ziegler-Nichols": (0.9 * 3 / 2, 3.33 * 0.1),
    "Chien 0 %": (0.35 * 3 / 2, 1.17 * 0.3),
    "Chien 20 %": (0.6 * 3 / 2, 0.3),
    "Cohen-Coon": ((0.9 * 3 + 0.083) / 2, 0.1 * (3.33 + 0.31 / 3) / (1 + 2.22 / 3)),
    "Rivera": (0.7 / (2 * 2 * 0.17), 0.35),
    "Skogestad": (3 / (2 * 2), 0.3),
    "AMIGO": ((0.15 + (0.35 - 0.03 / 0.16) * 3) / 2, 0.035 + 13 * 0.1 * 0.09 / (0.09 + 0.36 + 0.07)),
}
"""Gain and integral time, s, by O'Dwyer's tables with K = 2, T = 0.3 s, L = 0.1 s."""


@pytest.mark.parametrize("name", HANDBOOK)
def test_a_rule_is_the_handbooks(name: str) -> None:
    kc, integral_s = HANDBOOK[name]
    assert RULES[name](M) == pytest.approx((kc, kc * 0.005 / integral_s))
    assert set(RULES) == set(HANDBOOK)


def test_skogestad_s_integral_time_is_eight_dead_times_at_most() -> None:
    kc = 5.0 / (2 * 2 * 0.1)
    assert RULES["Skogestad"](FirstOrder(2.0, 5.0, 0.1)) == pytest.approx((kc, kc * 0.005 / 0.8))


def test_the_factor_is_the_larger_one_whichever_way() -> None:
    assert factor((2.0, 3.0), (1.0, 3.0)) == pytest.approx(2.0)
    assert factor((1.0, 1.0), (2.0, 5.0)) == pytest.approx(5.0)


@given(st.floats(0.1, 10.0), st.floats(0.1, 10.0))
def test_equal_gains_have_the_factor_one(kp: float, ki: float) -> None:
    assert factor((kp, ki), (kp, ki)) == 1.0
    assert factor((kp, ki), (ki, kp)) == pytest.approx(exp(abs(log(kp / ki))))


def test_E10_names_the_nearest_rules_and_the_model_in_ms(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(models, "identify", lambda make: M if isinstance(make(), StubBench) else None)
    found = tuning_rules.measure(benches(lambda *_: log_of(0.0)))
    own = LOW.controller.kp.si, LOW.controller.ki.si
    factors = {
        name: exp(max(abs(log(own[0] / kc)), abs(log(own[1] * integral_s / kc / 0.005))))
        for name, (kc, integral_s) in HANDBOOK.items()
    }
    for name, value in factors.items():
        assert found[name] == pytest.approx(value)
    first, second, *_ = sorted(factors.values())
    assert (found["nearest"], found["second"]) == pytest.approx((first, second))
    assert (found["gain"], found["lag"], found["dead time"]) == pytest.approx((2.0, 300.0, 100.0))
    assert set(tuning_rules.beside) >= {(name, "factor") for name in RULES}


def test_E9_is_the_rms_difference_and_the_last_third_of_the_effort() -> None:
    """A run that is equation (6) but for 6 arcsec/s and for four fifths of the effort."""
    gains = LOW.controller.kp.si, LOW.controller.ki.si
    rate, effort = simulate_loop(linear_axis(LOW), gains, round(LOW.controller.pwm_steps.si), 3.0)
    measured = 0.8 * effort[1::2]
    measured[:200] = 1e6

    def answer(loop: str, value: float, seconds: float) -> Log:
        assert (loop, value, seconds) == ("closed", 600.0, 3.0)
        return log_of(rate[1::2] + 6.0, 3.0, measured)

    found = equation_6.measure(benches(answer))
    assert found["difference"] == pytest.approx(1.0)
    assert found["effort"] == pytest.approx(25.0)
