"""Formulas of effects at single points: what their equations in the catalogue give, by hand."""

from math import exp, pi, sin

import numpy as np
import pytest

from plant.effects import cable_wrap, friction_asymmetry, load_friction, presliding, structural_mode
from plant.effects import signals as sig
from plant.evaluate import evaluate, signals


def at(**columns: float) -> np.ndarray:
    """One vector of signals."""
    return signals(1, {getattr(sig, name): np.array([value]) for name, value in columns.items()})


@pytest.mark.parametrize("motor", [0.0, 1.0])
@pytest.mark.parametrize("time_s", [0.0, 0.1, 0.37])
@pytest.mark.parametrize("shape", [0.0, 1.0])
def test_a_disturbed_command_pulls_with_the_motor_that_leads(
    motor: float, time_s: float, shape: float
) -> None:
    numbers = {"amplitude": 0.02, "frequency": 0.8, "phase": 0.3, "shape": shape}
    wave = sin(2 * pi * 0.8 * time_s + 0.3)
    expected = 0.02 * (np.sign(wave) if shape else wave) * (-1 if motor else 1)
    (leads,) = evaluate("command_disturbance", at(TIME=time_s, MOTOR=motor), numbers)
    (lags,) = evaluate("command_disturbance", at(TIME=time_s, MOTOR=motor, LAGGING=1.0), numbers)
    assert leads == pytest.approx(expected)
    assert lags == 0.0


@pytest.mark.parametrize("turns", [-2, 0, 5])
@pytest.mark.parametrize("away", [-0.45, -0.2, 0.0, 0.2, 0.45])
def test_a_damaged_tooth_pushes_once_a_turn_of_its_shaft(turns: int, away: float) -> None:
    numbers = {"order": 7.0, "amplitude": 60.0, "phase": 1.1, "width": 0.15}
    angle = (1.1 + 2 * pi * turns + away) / 7.0
    (torque,) = evaluate("damaged_tooth", at(ANGLE=angle), numbers)
    assert torque == pytest.approx(60.0 * exp(-(away**2) / (2 * 0.15**2)))
    (opposite,) = evaluate("damaged_tooth", at(ANGLE=angle + pi / 7.0), numbers)
    assert abs(opposite) < 1e-6


def test_presliding_scales_stiffness_and_damping_of_the_bristles() -> None:
    x = at(SIGMA0=1e7, SIGMA1=2e4, COULOMB=100.0)[0]
    presliding.formula(x, 0.5, 1.7)
    assert (x[sig.SIGMA0], x[sig.SIGMA1], x[sig.COULOMB]) == pytest.approx((5e6, 3.4e4, 100.0))


@pytest.mark.parametrize(("rate", "side"), [(1e-4, 1.0), (-1e-4, -1.0)])
def test_friction_differs_by_direction(rate: float, side: float) -> None:
    x = at(RATE=rate, COULOMB=100.0, STICTION=150.0, SIGMA2=2000.0)[0]
    friction_asymmetry.formula(x, 0.1, 0.2)
    expected = (100 * (1 + 0.1 * side), 150 * (1 + 0.1 * side), 2000 * (1 + 0.2 * side))
    assert (x[sig.COULOMB], x[sig.STICTION], x[sig.SIGMA2]) == pytest.approx(expected)


def test_a_load_of_either_sign_presses_the_bearing() -> None:
    for load in (40.0, -40.0):
        x = at(TORQUE=load, COULOMB=100.0, STICTION=150.0)[0]
        load_friction.formula(x, 0.05)
        assert (x[sig.COULOMB], x[sig.STICTION]) == pytest.approx((102.0, 152.0))


def test_a_cable_is_a_spring_with_dahls_hysteresis() -> None:
    """After a travel of s the wrap is 1 - (1 - start) exp(-s / width), in the direction of motion."""
    x = at(ANGLE=0.3, RATE=2e-3)[0]
    assert cable_wrap.formula(x, 0.5, 20.0, 0.1, 8.0) == pytest.approx(-20.0 * 0.2 - 8.0 * 0.5)
    width, start = 0.01, -0.4
    for rate, goal in ((2e-3, 1.0), (-2e-3, -1.0)):
        wrap, x[sig.RATE] = start, rate
        for _ in range(9):
            wrap = cable_wrap.update(x, 0.25, wrap, width)
        assert wrap == pytest.approx(goal + (start - goal) * exp(-9 * 0.25 * 2e-3 / width))


def test_a_second_mass_swings_at_its_frequency_and_dies_by_its_damping() -> None:
    """Let go at a lead, the axis held: after a period, less by exp(-2 pi damping) of the lead."""
    frequency, damping, dt = 9.0, 0.02, 1e-5
    x = np.zeros(sig.VECTOR)
    lead, rate, axis = 1e-3, 0.0, 0.0
    for _ in range(round(1 / frequency / dt)):
        lead, rate, axis = structural_mode.update(x, dt, lead, rate, axis, frequency, damping)
    assert lead == pytest.approx(1e-3 * exp(-2 * pi * damping), rel=2e-3)
    assert axis == x[sig.RATE]


def test_the_torque_of_a_second_mass_is_its_spring_and_its_damper() -> None:
    x = at(RATE=2e-3)[0]
    w = 2 * pi * 9.0
    torque = structural_mode.formula(x, 1e-3, 5e-3, 9.0, 0.02, 200.0)
    assert torque == pytest.approx(200.0 * (w**2 * 1e-3 + 2 * 0.02 * w * 3e-3))


@pytest.mark.parametrize(
    ("name", "numbers", "columns", "expected"),
    [
        ("adc_gain", {"gain": 1.1, "motor": 0.0}, {"CURRENT": 2.0}, 0.2),
        ("supply_sag", {"resistance": 0.3}, {"SUPPLY_CURRENT": 4.0}, -1.2),
        ("backlash_loss", {"loss": 0.5}, {"COMMAND": 0.2, "LAGGING": 1.0}, -0.1),
        ("backlash_loss", {"loss": 0.5}, {"COMMAND": 0.2}, 0.0),
        ("magnet_weakening", {"loss": 0.12, "motor": 0.0}, {"MOTOR": 1.0}, -0.12),
        ("magnet_weakening", {"loss": 0.12, "motor": 1.0}, {"MOTOR": 0.0}, -0.12),
        ("magnet_weakening", {"loss": 0.12, "motor": 1.0}, {"MOTOR": 1.0}, 0.0),
    ],
)
def test_what_motors_and_supply_do(
    name: str, numbers: dict[str, float], columns: dict[str, float], expected: float
) -> None:
    (value,) = evaluate(name, at(**columns), numbers)
    assert value == pytest.approx(expected)


@pytest.mark.parametrize("motor", [0.0, 1.0])
def test_cogging_is_a_wave_of_the_motor_it_belongs_to(motor: float) -> None:
    numbers = {"cycles": 20.0, "amplitude": 0.03, "phase": 0.7, "motor": 1.0}
    (torque,) = evaluate("motor_cogging", at(MOTOR_ANGLE=0.31, MOTOR=motor), numbers)
    assert torque == pytest.approx(0.0 if motor else 0.03 * sin(20.0 * 0.31 + 0.7))
