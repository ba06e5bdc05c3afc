"""Formulas that change friction, readings and motors, at single points: their equations by hand."""

from collections.abc import Mapping
from math import cos, exp, pi, sin

import numpy as np
import pytest

from plant.effects import REGISTRY, friction_warmup, preload_change, stribeck_change, wind_torque
from plant.effects import signals as sig
from plant.evaluate import evaluate, signals
from plant.kernels.noise import normal

FRICTION = {
    "SIGMA0": 6e6, "SIGMA1": 4e3, "SIGMA2": 7e3, "COULOMB": 200.0, "STICTION": 600.0, "STRIBECK_RATE": 4e-4,
    "STRIBECK_EXPONENT": 2.0,
}  # fmt: skip


def at(columns: Mapping[str, float]) -> np.ndarray:
    """One vector of signals."""
    return signals(1, {getattr(sig, name): np.array([value]) for name, value in columns.items()})


def changed(name: str, numbers: Mapping[str, float], **columns: float) -> dict[str, float]:
    """Friction parameters that an effect makes others, by hand of its formula."""
    effect = REGISTRY[name]
    (term,) = effect.terms
    x = at(FRICTION | columns)[0]
    assert term.formula is not None
    assert term.formula(x, **numbers) is None
    after = {word: float(x[getattr(sig, word)]) for word in FRICTION}
    return {word: value for word, value in after.items() if value != FRICTION[word]}


def test_a_brake_drags_from_its_start_for_its_duration() -> None:
    numbers = {"torque": 60.0, "start": 5.0, "duration": 2.0}
    for time_s, drags in ((4.999, False), (5.0, True), (6.999, True), (7.0, False)):
        found = changed("brake_drag", numbers, TIME=time_s)
        assert found == ({"COULOMB": 260.0, "STICTION": 660.0} if drags else {})


@pytest.mark.parametrize(("factor", "stiction"), [(0.5, 600.0), (1.5, 600.0), (3.5, 700.0)])
def test_stiction_never_falls_below_coulomb_s_friction(factor: float, stiction: float) -> None:
    expected = {"COULOMB": 200 * factor} | ({"STICTION": stiction} if stiction != 600.0 else {})
    assert changed("coulomb_change", {"factor": factor}) == pytest.approx(expected)


def test_friction_s_parameters_are_scaled_one_by_one() -> None:
    assert changed("viscous_change", {"factor": 0.25}) == {"SIGMA2": 1750.0}
    x = at(FRICTION)[0]
    stribeck_change.formula(x, 1.25, 0.5, -0.75)
    found = x[sig.STICTION], x[sig.STRIBECK_RATE], x[sig.STRIBECK_EXPONENT], x[sig.COULOMB]
    assert found == pytest.approx((750.0, 2e-4, 1.25, 200.0))


@pytest.mark.parametrize(
    ("time_s", "share"), [(-1.0, 0.0), (10.0, 0.0), (11.0, 0.25), (13.0, 0.75), (14.0, 1.0), (99.0, 1.0)]
)
def test_a_preload_changes_along_a_ramp(time_s: float, share: float) -> None:
    x = at(FRICTION | {"TIME": time_s})[0]
    preload_change.formula(x, 0.5, 10.0, 4.0)
    assert (x[sig.STICTION], x[sig.SIGMA2]) == pytest.approx((600 * (1 + share / 2), 7e3 * (1 + share / 2)))
    x = at(FRICTION | {"TIME": time_s})[0]
    preload_change.formula(x, -0.9, 10.0, 4.0)
    assert x[sig.STICTION] == pytest.approx(max(200.0, 600 * (1 - 0.9 * share)))


def test_a_warm_axis_has_other_friction_and_cools_at_rest() -> None:
    """1 - a exp(-t / tau): all of the depth when cold."""
    for warmth, factor in ((0.0, 1.3), (0.75, 1.075), (1.0, 1.0)):
        x = at(FRICTION)[0]
        friction_warmup.formula(x, warmth, -0.3)
        expected = [200 * factor, 600 * factor, 7e3 * factor]
        assert [x[sig.COULOMB], x[sig.STICTION], x[sig.SIGMA2]] == pytest.approx(expected)
    for rate, goal in ((2e-6, 1.0), (-2e-6, 1.0), (0.9e-6, 0.0), (1e-6, 0.0), (0.0, 0.0)):
        after = friction_warmup.update(at({"RATE": rate})[0], 3.0, 0.4, 60.0)
        assert after == pytest.approx(goal + (0.4 - goal) * exp(-3.0 / 60.0))


@pytest.mark.parametrize(
    ("change", "coulomb", "stiction"), [(30.0, 230.0, 630.0), (-250.0, 0.0, 350.0), (-900.0, 0.0, 0.0)]
)
def test_friction_over_the_angle_is_never_below_nothing(
    change: float, coulomb: float, stiction: float
) -> None:
    """A wave of 7 cycles a turn, at its crest."""
    numbers = {"order": 7.0, "amplitude": change, "phase": 0.7}
    x = at(FRICTION | {"ANGLE": 0.1})[0]
    formula = REGISTRY["position_friction"].terms[0].formula
    assert formula is not None
    formula(x, **numbers)
    assert (x[sig.COULOMB], x[sig.STICTION]) == (coulomb, stiction)
    x = at(FRICTION | {"ANGLE": 0.3})[0]
    formula(x, 7.0, 30.0, 0.5)
    assert x[sig.COULOMB] - 200.0 == pytest.approx(30 * cos(1.6)) == pytest.approx(x[sig.STICTION] - 600.0)


SECOND = {"order": 3.0, "amplitude": 2.0, "phase": 0.4, "second": 0.5, "second_phase": -0.9}


@pytest.mark.parametrize(
    ("name", "numbers", "columns", "expected"),
    [
        ("bearing_pass", {"order": 437.3, "amplitude": 9.0, "phase": 0.3}, {"ANGLE": 0.02},
         9 * sin(8.746 + 0.3)),
        ("gear_mesh", {"order": 250.0, "amplitude": 9.0, "phase": 0.3}, {"ANGLE": 0.02}, 9 * sin(5.3)),
        ("gravity_imbalance", {"amplitude": 40.0, "phase": 0.3}, {"ANGLE": 0.5}, 40 * cos(0.2)),
        ("torque_ripple", {"cycles": 37.0, "ripple": 0.05, "phase": 0.3, "motor": 0.0}, {"MOTOR_ANGLE": 0.1},
         0.05 * cos(4.0)),
        ("encoder_eccentricity", SECOND, {"ANGLE": 0.2}, 2 * sin(1.0) + 0.5 * sin(0.3)),
        ("encoder_subdivision", {"lines": 100.0, "encoder": 1.0} | {k: v for k, v in SECOND.items()
                                                                     if k != "order"},
         {"ANGLE": 0.02}, 2 * sin(2.4) + 0.5 * sin(3.1)),
        ("encoder_thermal_drift", {"drift": 3.0, "encoder": 1.0}, {"TEMPERATURE": 12.5}, -22.5),
        ("roller_ratio", {"error": 5e-4}, {"ANGLE": -2.0}, -1e-3),
        ("adc_offset", {"offset": 0.07, "motor": 0.0}, {"CURRENT": 3.0}, 0.07),
        ("pwm_deadband", {"deadband": 0.01}, {"COMMAND": 0.3}, -0.01),
        ("pwm_deadband", {"deadband": 0.01}, {"COMMAND": 0.004}, -0.004),
        ("shaft_compliance", {"compliance": 2e-7}, {"TORQUE": 30.0}, -6e-6),
        ("command_disturbance", {"amplitude": 0.1, "frequency": 2.0, "phase": pi, "shape": 0.5},
         {"TIME": 0.1}, 0.1 * sin(0.4 * pi + pi)),
        ("command_disturbance", {"amplitude": 0.1, "frequency": 0.8, "phase": 0.3, "shape": 1.0},
         {"TIME": 0.8}, -0.1),
    ],
)  # fmt: skip
def test_a_formula_is_its_equation(
    name: str, numbers: dict[str, float], columns: dict[str, float], expected: float
) -> None:
    (value,) = evaluate(name, at(columns), numbers)
    assert value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("motor", [0.0, 1.0])
@pytest.mark.parametrize("speed", [-10.0, -2.0, 0.0, 10.0])
def test_a_motor_that_turns_against_its_pull_brakes_by_its_diode(motor: float, speed: float) -> None:
    """K |w| less the drop, over the loop's resistance, is the current; A pulls in +, B in -."""
    numbers = {"share": 0.5, "drop": 0.6, "torque_constant": 0.4, "resistance": 2.5, "ratio": 360.0}
    (torque,) = evaluate("diode_braking", at({"MOTOR_RATE": speed, "MOTOR": motor}), numbers)
    side = 1.0 if motor == 0.0 else -1.0
    amperes = max(0.0, 0.4 * -side * speed - 0.6) / 2.5
    assert torque == pytest.approx(side * 0.5 * amperes * 0.4 * 360.0)


@pytest.mark.parametrize(
    ("acceleration", "rate", "lost"),
    [(0.3, 0.02, -0.05), (-0.3, 0.02, -0.05), (0.5, 0.02, -0.055 - 0.002), (-0.5, -0.01, -0.0475 + 0.002)],
)
def test_a_roller_loses_travel_while_it_is_accelerated(acceleration: float, rate: float, lost: float) -> None:
    """Beyond 0.3 rad/s2 a quarter of the rate for a second, and 0.01 s of the rest; before, 0.05 rad."""
    numbers = {"slip": 0.25, "threshold": 0.3, "creep": 0.01}
    update = REGISTRY["roller_slip"].terms[0].update
    assert update is not None
    found = update(at({"ACCELERATION": acceleration, "RATE": rate})[0], 1.0, -0.05, **numbers)
    assert found == pytest.approx(lost)


def test_play_is_pushed_along_at_either_end() -> None:
    update = REGISTRY["play"].terms[0].update
    assert update is not None
    for offset, rate, after in ((0.0, 0.1, -0.02), (0.0, 1.0, -0.05), (0.0, -1.0, 0.05), (0.05, 0.1, 0.03)):
        assert update(at({"RATE": rate})[0], 0.2, offset, 0.1) == pytest.approx(after)


def test_a_winding_warms_by_its_loss() -> None:
    """Copper has 0.393 % more per kelvin; towards Rth i^2 R, by its time constant."""
    term = REGISTRY["winding_heating"].terms[0]
    assert term.formula is not None and term.update is not None
    assert term.formula(at({})[0], 50.0, 2.0) == pytest.approx(2.0 * 0.00393 * 50.0)
    after = term.update(at({"CURRENT": 3.0})[0], 30.0, 10.0, 1.5, 600.0, 2.0)
    assert after == pytest.approx(27.0 + (10.0 - 27.0) * exp(-30.0 / 600.0))


def test_wind_is_one_noise_through_three_lags() -> None:
    """Lags and shares of the fit; the noise of a microsecond is that of seed and time."""
    lags, shares = (1.148, 0.1318, 0.01076), (0.9263, 0.06194, 0.00787)
    tau, dt, before = 2.0, 0.0005, (0.3, -0.2, 0.7)
    x = at({"TIME": 1.2345675})[0]
    with np.errstate(over="ignore"):  # its whole numbers wrap
        noise = np.sqrt(2 * tau / dt) * normal(77.0, 1234567.0)
        after = wind_torque.update(x, dt, *before, 77.0, tau)
    expected = [
        was + (1 - exp(-dt / (lag * tau))) * (noise - was) for was, lag in zip(before, lags, strict=True)
    ]
    assert after == pytest.approx(expected)
    torque = wind_torque.formula(x, *before, 10.0, 5.0)
    assert torque == pytest.approx(10 + 5 * sum(s * b for s, b in zip(shares, before, strict=True)))


def test_a_second_mass_is_pulled_by_its_spring_and_damped_by_the_axis() -> None:
    """Newton for a step: its rate by lead and difference of rates, then its lead by the new difference."""
    update = REGISTRY["structural_mode"].terms[0].update
    assert update is not None
    pulse, dt = 2 * pi * 9.0, 1e-3
    rate = 0.5 - dt * (pulse**2 * 2e-3 + 2 * 0.1 * pulse * (0.5 - 0.2))
    after = update(at({"RATE": 0.3})[0], dt, 2e-3, 0.5, 0.2, 9.0, 0.1)
    assert after == pytest.approx((2e-3 + dt * (rate - 0.3), rate, 0.3))
