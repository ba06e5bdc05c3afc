"""E9 and E10: the linear axis by hand, its loop in limits that have formulas, factors between gains."""

from dataclasses import replace
from itertools import pairwise
from math import exp

import numpy as np
import pytest

from plant.model import load, with_value
from scenarios.studies.options import LOW
from scenarios.studies.paper.experiments import models
from scenarios.studies.paper.experiments.identify import FirstOrder
from scenarios.studies.paper.experiments.models import RULES, LinearAxis, factor, linear_axis, simulate_loop
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.scales import ARCSEC, COUNT_RATE, GEAR_RATIO
from scenarios.studies.paper.starts import STARTS, Benches
from tests.studies.paper.commanded import Commanded
from tests.studies.paper.synthetic import log_of

AXIS = LinearAxis(
    torque_constant=0.6, resistance=2.0, inductance=0.004, inertia=0.01, viscous=0.05, stiction=0.1,
    voltage=24.0, drive=0.9,
)  # fmt: skip
MODEL = load(LOW)


def test_equation_6_is_reflected_to_the_motor_shaft() -> None:
    found, ra = linear_axis(MODEL), MODEL.axes.ra
    assert found.inertia == pytest.approx(ra.inertia.si / GEAR_RATIO**2 + 2 * ra.motor.rotor_inertia.si)
    assert found.viscous == pytest.approx(ra.friction.viscous.si / GEAR_RATIO**2)
    assert ra.motor.drag.si == 0.0
    dragged = linear_axis(with_value(MODEL, "axes.ra.motor.drag", 1e-3))
    assert dragged.viscous - found.viscous == pytest.approx(2e-3)  # of both motors
    assert found.stiction == pytest.approx(0.621)  # this plant takes Table 2 for the motor's
    assert found.drive == pytest.approx(0.9)  # the counter motor has a tenth (paper 3.3)
    assert (found.voltage, found.resistance) == (24.0, ra.motor.loop)
    assert found.torque_constant == ra.motor.torque_constant.si
    assert found.inductance == ra.motor.inductance.si


def test_a_saturated_effort_leads_to_the_speed_of_its_balance() -> None:
    weak = replace(AXIS, voltage=0.9)
    rate, efforts = simulate_loop(weak, (0.0, 1e6), 7, 0.6)
    volt = 0.9 * 0.9 - 0.1 * 2.0 / 0.6  # what stiction leaves of the whole supply
    speed = volt / (0.6 + 2.0 * 0.05 / 0.6) / GEAR_RATIO / ARCSEC
    assert speed < 400 and rate[-1] == pytest.approx(speed, rel=0.01)
    assert len(rate) == len(efforts) == 120 and efforts[0] == 3000.0


def test_an_effort_acts_half_a_period_late_and_the_set_point_rises_at_2_degrees_per_square_second() -> None:
    quick = replace(AXIS, inductance=1e-7, stiction=0.0, viscous=0.0, inertia=1e9)
    gains = (10.0, 0.0)
    rate, efforts = simulate_loop(quick, gains, 3000, 0.02)
    asked = [36.0, 72.0, 108.0, 144.0]  # arcsec/s: 7200 arcsec/s2 for 5 ms each
    assert efforts == pytest.approx([10.0 * each / COUNT_RATE for each in asked], rel=1e-6)
    # at nearly no speed a period adds volt k / R / J dt, in its first half that of the effort before
    push = [0.0, 0.0, *efforts]
    speed, means = 0.0, []
    for before, now in pairwise(push[:5]):
        added = [each / 3000 * 24.0 * 0.9 * 0.6 / 2.0 / 1e9 * 1e-4 for each in [before] * 25 + [now] * 25]
        track = speed + np.cumsum(added)
        speed = float(track[-1])
        means.append(float(track.mean()) / GEAR_RATIO / ARCSEC)
    assert rate == pytest.approx(means, rel=1e-3, abs=1e-15)


def test_the_loop_takes_both_gains_and_comes_to_its_set_point() -> None:
    rate, efforts = simulate_loop(AXIS, (0.5, 0.05), 3000, 1.5)
    assert rate[-1] == pytest.approx(600.0, rel=1e-3)
    volt = 600.0 * ARCSEC * GEAR_RATIO * (0.6 + 2.0 * 0.05 / 0.6) + 0.1 * 2.0 / 0.6
    assert efforts[-1] == pytest.approx(volt / 24.0 / 0.9 * 3000, rel=1e-3)
    other = simulate_loop(AXIS, (0.5, 0.05), 1500, 1.5)[1]  # half as many steps: the same voltage
    assert other[-1] == pytest.approx(efforts[-1], rel=1e-3)


def test_stiction_holds_and_never_pushes_back() -> None:
    rate, efforts = simulate_loop(replace(AXIS, stiction=100.0), (0.1, 0.001), 3000, 0.5)
    assert not rate.any() and (np.diff(efforts) > 0).all()


def test_a_lag_of_the_winding_holds_the_current_back() -> None:
    slow = simulate_loop(replace(AXIS, inductance=0.2), (5.0, 0.0), 3000, 0.03)[0]
    quick = simulate_loop(AXIS, (5.0, 0.0), 3000, 0.03)[0]
    assert 0.0 < slow[-1] < 0.3 * quick[-1]


@pytest.mark.parametrize(("kp", "ki"), [(0.5, 1.2), (1.2, 0.25), (3.0, 2.0), (1.0, 1.0)])
def test_a_factor_is_one_or_more_and_the_same_from_either_side(kp: float, ki: float) -> None:
    assert factor((kp, ki), (1.0, 1.0)) == pytest.approx(max(kp, 1 / kp, ki, 1 / ki))
    assert factor((1.0, 1.0), (kp, ki)) == pytest.approx(factor((kp, ki), (1.0, 1.0)))


def test_the_rules_reach_their_other_branch() -> None:
    kp, ki = RULES["Skogestad"](FirstOrder(1.0, 1.0, 0.01))  # 8 L is less than T
    assert kp == pytest.approx(50.0) and ki == pytest.approx(50.0 * 0.005 / 0.08)


def test_E10_names_the_two_nearest_rules(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(models, "identify", lambda make: FirstOrder(2.0, 0.1, 0.02))
    found = models.tuning_rules.measure(Benches(lambda *_: Commanded(), {"low": MODEL}, STARTS[0]))
    kp, ki = MODEL.controller.kp.si, MODEL.controller.ki.si
    by_hand = {"Chien 20 %": (1.5, 0.075), "Skogestad": (1.25, 0.0625), "AMIGO": (0.60278, 0.038813)}
    for name, (p, i) in by_hand.items():
        assert found[name] == pytest.approx(max(kp / p, p / kp, ki / i, i / ki), rel=1e-3)
    factors = sorted(found[name] for name in RULES)
    assert [found["nearest"], found["second"]] == factors[:2]
    assert (found["gain"], found["lag"], found["dead time"]) == pytest.approx((2.0, 100.0, 20.0))
    assert [name for name, _ in models.tuning_rules.beside][-len(RULES) :] == list(RULES)


class Compared(Commanded):
    """Answers with every second tick of a response, times factors."""

    def __init__(self, response: tuple[np.ndarray, np.ndarray], of_rate: float, of_effort: float) -> None:
        super().__init__()
        self.answer = log_of(of_rate * response[0][1::2], of_effort * response[1][1::2])

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        super().closed_loop(arcsec_s, seconds)
        return self.answer


def test_E9_is_the_rms_difference_and_that_of_the_settled_efforts(monkeypatch: pytest.MonkeyPatch) -> None:
    response = np.linspace(1.0, 600.0, 600), np.linspace(100.0, 200.0, 600)
    asked: list[object] = []

    def simulated(*arguments: object) -> tuple[np.ndarray, np.ndarray]:
        asked.append(arguments)
        return response

    monkeypatch.setattr(models, "simulate_loop", simulated)
    same, other, late = (
        Compared(response, 1.0, 1.0),
        Compared(response, 1.1, 0.8),
        Compared(response, 1.0, 1.0),
    )
    late.answer.effort[:-100] = 0.0  # the last second of three alone counts
    found = [
        models.equation_6.measure(Benches(lambda *_, bench=bench: bench, {"low": MODEL}, STARTS[0]))
        for bench in (same, other, late)
    ]
    gains = MODEL.controller.kp.si, MODEL.controller.ki.si
    assert asked[0] == (linear_axis(MODEL), gains, round(MODEL.controller.pwm_steps.si), 3.0)
    assert same.commands == [("closed", 600.0, 3.0)]
    assert found[0] == pytest.approx({"difference": 0.0, "effort": 0.0}, abs=1e-9)
    off = 0.1 * np.sqrt(np.mean(response[0][1::2] ** 2)) / 600.0 * 100.0
    assert found[1] == pytest.approx({"difference": off, "effort": 25.0})
    assert found[2]["effort"] == pytest.approx(0.0, abs=1e-9)


def test_a_current_settles_by_the_windings_time_constant() -> None:
    """A rotor that cannot move: the torque after a time is that of an exponential."""
    heavy = replace(AXIS, inertia=1e6, viscous=0.0, stiction=0.0, inductance=0.02)
    rate, _ = simulate_loop(heavy, (1e9, 0.0), 3000, 0.02)
    t = np.arange(1, 126) * 1e-4  # the full effort acts from 7.5 ms on
    current = 24.0 * 0.9 / 2.0 * (1 - np.exp(-t * 2.0 / 0.02))
    speed = np.cumsum(current) * 0.6 / 1e6 * 1e-4
    assert rate[-1] == pytest.approx(speed[-50:].mean() / GEAR_RATIO / ARCSEC, rel=1e-6)
    assert 1 - exp(-1.25) == pytest.approx(current[-1] / 10.8, rel=1e-9)
