"""The axis as a linear system: what mechanics and Ohm's law say of it, by hand."""

from dataclasses import replace
from math import exp, pi, sqrt

import numpy as np
import pytest

from plant.gears import RATIO
from plant.linear import (
    ANGLE,
    BRISTLE,
    RATE,
    ROTOR_A,
    ROTOR_B,
    SIZE,
    SPEED_A,
    SPEED_B,
    TORQUE_A,
    TORQUE_B,
    continuous,
    stepped,
)  # fmt: skip
from plant.model import load, with_value
from plant.parts import Number, PlantModel
from plant.units import ARCSEC

TRACKING = 15.041 * ARCSEC


@pytest.fixture(scope="module")
def model() -> PlantModel:
    return load("low_preload_bridge")


def system(model: PlantModel, rate: float = TRACKING) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    return continuous(model, model.axes.ra, rate)


def test_what_is_held_over_a_time_adds_up_exactly() -> None:
    """Of place and speed under a force; and of a lag."""
    step, push = stepped(np.array([[0.0, 1.0], [0.0, 0.0]]), np.array([[0.0], [4.0]]), 0.5)
    assert step == pytest.approx(np.array([[1.0, 0.5], [0.0, 1.0]]))
    assert push[:, 0] == pytest.approx([4.0 * 0.5**2 / 2, 4.0 * 0.5])
    lag, level = stepped(np.array([[-1 / 3]]), np.array([[6 / 3, 9 / 3]]), 0.7)
    assert lag[0, 0] == pytest.approx(exp(-0.7 / 3))
    assert level[0] == pytest.approx((1 - exp(-0.7 / 3)) * np.array([6.0, 9.0]))


@pytest.mark.parametrize(("inertia", "published_hz"), [(2200.0, 5.96)])
def test_with_locked_rotors_the_axis_swings_as_table_1_says(inertia: float, published_hz: float) -> None:
    printed = with_value(load("low_preload"), "axes.ra.inertia", inertia)
    a, _, _ = system(printed)
    assert sqrt(-a[RATE, ANGLE]) / (2 * pi) == pytest.approx(published_hz, abs=0.01)


def test_every_torque_between_two_parts_pushes_both(model: PlantModel) -> None:
    """Newton's third law: only friction, motors and what comes from outside change the momentum of all."""
    part = model.axes.ra
    a, _, push = system(model)
    momentum = np.zeros(SIZE)
    momentum[RATE], momentum[[SPEED_A, SPEED_B]] = part.inertia.si, part.motor.rotor_inertia.si * RATIO**2
    outside = momentum @ a
    damping = part.friction.bristle_damping.si / part.friction.bristle_stiffness.si
    friction = -damping * a[BRISTLE]
    friction[BRISTLE] -= 1.0
    friction[RATE] -= part.friction.viscous.si
    friction[[TORQUE_A, TORQUE_B]] += 1.0
    assert outside == pytest.approx(friction, rel=1e-9, abs=1e-6)
    assert momentum @ push[:, 0] == pytest.approx(1.0)


def test_trains_are_springs_with_damping_between_axis_and_rotors(model: PlantModel) -> None:
    """Half of the stiffness each; what one rotor is ahead pulls the axis after it and the rotor back."""
    gear, part = model.axes.ra.gear, model.axes.ra
    a, _, _ = system(model)
    rotor = part.motor.rotor_inertia.si * RATIO**2
    for angle, speed, other in ((ROTOR_A, SPEED_A, SPEED_B), (ROTOR_B, SPEED_B, SPEED_A)):
        assert a[RATE, angle] * part.inertia.si == pytest.approx(gear.stiffness.si / 2)
        assert a[speed, angle] * rotor == pytest.approx(-gear.stiffness.si / 2)
        assert a[speed, ANGLE] * rotor == pytest.approx(gear.stiffness.si / 2)
        assert a[speed, speed] * rotor == pytest.approx(-gear.damping.si / 2)
        assert a[speed, RATE] * rotor == pytest.approx(gear.damping.si / 2)
        assert a[other, angle] == a[other, speed] == 0.0
        assert np.array_equal(np.flatnonzero(a[angle]), [speed]) and a[angle, speed] == 1.0
    assert np.array_equal(np.flatnonzero(a[ANGLE]), [RATE]) and a[ANGLE, RATE] == 1.0


@pytest.mark.parametrize("rate", [TRACKING, 100 * TRACKING])
def test_the_bristle_is_lugres_around_its_steady_force(model: PlantModel, rate: float) -> None:
    """de Wit 1995: dz/dt = v - sigma0 |v| z / g(v). Of the force sigma0 z, around the z that rests."""
    f = model.axes.ra.friction

    def level(v: float) -> float:
        return f.coulomb.si + (f.stiction.si - f.coulomb.si) * exp(
            -((v / f.stribeck_rate.si) ** f.stribeck_exponent.si)
        )

    def change(v: float, force: float) -> float:
        return f.bristle_stiffness.si * (v - v * force / level(v))

    force, dv, df = level(rate), 1e-5 * rate, 1e-5 * level(rate)
    a, _, _ = system(model, rate)
    by_rate = (change(rate + dv, force) - change(rate - dv, force)) / (2 * dv)
    by_force = (change(rate, force + df) - change(rate, force - df)) / (2 * df)
    assert a[BRISTLE, RATE] == pytest.approx(by_rate, rel=1e-4)
    assert a[BRISTLE, BRISTLE] == pytest.approx(by_force, rel=1e-6)


@pytest.mark.parametrize("diode", [None, 0.7])
def test_a_motor_is_a_voltage_behind_resistance_and_inductance(
    model: PlantModel, diode: float | None
) -> None:
    """L di/dt = u V / steps - R i - K w. Without a bias, the motor that lags gives a steady torque.

    With one the current freewheels: past switch and sense resistor, and against the drop of the diodes."""
    drop = None if diode is None else Number(diode, "V", "a test")
    part = replace(model.axes.ra, motor=replace(model.axes.ra.motor, diode_drop=drop))
    a, b, _ = continuous(model, part, TRACKING)
    motor = part.motor
    ohm = motor.resistance.si
    if diode is None:
        ohm += motor.switch_resistance.si + motor.sense_resistance.si
    constant, per_s = motor.torque_constant.si * RATIO, ohm / motor.inductance.si
    volts = (model.supply.voltage.si + (diode or 0.0)) / model.controller.pwm_steps.si
    assert np.array_equal(np.flatnonzero(b[:, 0]), [TORQUE_A])
    assert b[TORQUE_A, 0] == pytest.approx(constant * volts / motor.inductance.si)
    for speed, torque, brakes in ((SPEED_A, TORQUE_A, True), (SPEED_B, TORQUE_B, diode is not None)):
        assert a[torque, torque] == pytest.approx(-per_s)
        assert a[torque, speed] == pytest.approx(-(constant**2) / motor.inductance.si if brakes else 0.0)
        assert a[speed, torque] == pytest.approx(1.0 / (motor.rotor_inertia.si * RATIO**2))


def test_one_input_and_one_disturbance(model: PlantModel) -> None:
    a, b, push = system(model)
    assert a.shape == (SIZE, SIZE) and b.shape == push.shape == (SIZE, 1)
