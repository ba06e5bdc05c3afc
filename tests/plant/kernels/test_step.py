"""One grid step of one axis, each number by hand."""

from math import exp

import numpy as np
import pytest

from plant.compiled import Floats
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.motor import motor_step
from plant.kernels.stage import stage
from plant.kernels.step import axis_step, gears

H = 1e-3
A, B = at.MOTORS, at.MOTORS + at.MOTOR_SIZE
PUSHES = (20.7, -15.9)
"""N m of the trains of `row`: 100 N m/rad beyond the play of 0.1 rad, 2 N m s/rad.

Rates are extrapolated by half a step. Axis: 1.5 * 0.2 - 0.5 * 0.1 = 0.25 rad/s, A: 0.6, B: -0.2 at the axis.
A: 100 * (1.3 - 1 - 0.1) + 2 * 0.35; B: 100 * (0.75 - 1 + 0.1) - 2 * 0.45."""


@pytest.fixture
def row() -> Floats:
    """An axis amid a motion, another number in every place."""
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.RATE], w[at.RATE_BEFORE], w[at.ANGLE] = H, 0.2, 0.1, 1.0
    w[at.INERTIA], w[at.STEP] = 2.0, 7.0
    w[at.RATIO], w[at.GEAR_STIFFNESS], w[at.GEAR_DAMPING], w[at.HALF_PLAY] = 10.0, 100.0, 2.0, 0.1
    for o, numbers in ((A, (5.0, 13.0, 3.0, 2.0, PUSHES[0])), (B, (-1.0, 7.5, 1.0, 1.0, PUSHES[1]))):
        w[o : o + at.MOTOR_SIZE] = numbers
    w[at.VOLTAGE], w[at.RESISTANCE], w[at.TORQUE_CONSTANT], w[at.ROTOR_DRAG] = 24.0, 2.0, 0.5, 0.01
    w[at.INDUCTANCE], w[at.CURRENT_DECAY], w[at.CURRENT_BLEND], w[at.ROTOR_INERTIA] = 0.01, 0.5, 0.75, 0.02
    w[at.MEAN_DUTY], w[at.MEAN_DUTY + 1] = 0.5, 0.25
    f = at.DECLARED_FRICTION
    w[f + at.F_SIGMA0], w[f + at.F_SIGMA2], w[f + at.F_COULOMB], w[f + at.F_STICTION] = 1000.0, 4.0, 1.5, 1.5
    w[f + at.F_RATE], w[f + at.F_EXPONENT], w[at.BRISTLE], w[at.STRIBECK] = 1.0, 1.0, 1e-3, 1.5e-3
    return w


@pytest.mark.parametrize(
    ("error", "pushes"), [(0.0, PUSHES), (0.05, (25.7, -10.9)), (-0.25, (0.0, -40.9)), (0.2, (40.7, 0.0))]
)
def test_P3_trains_push_by_twist_and_rate(row: Floats, error: float, pushes: tuple[float, float]) -> None:
    assert gears(row, 0.25, error) == pytest.approx(sum(pushes))
    assert (row[A + at.M_GEAR], row[B + at.M_GEAR]) == pytest.approx(pushes)


@pytest.mark.parametrize(("m", "drawn", "current", "rate"), [
    # A at 6 rad/s: 12 V less 3 V over 2 ohm, from 2 A half the way; 0.5 * 2.625 - 20.7 / 10 - 0.06 N m
    (0, 0.5 * 2.625, 3.25, 5.0 + H * (1.3125 - 2.13) / 0.02),
    # B pulls the other way, at 2 rad/s of its own: 6 V less 1 V; -0.5 * 1.375 + 15.9 / 10 + 0.02 N m
    (1, 0.25 * 1.375, 1.75, -1.0 + H * (-0.6875 + 1.61) / 0.02),
])  # fmt: skip
def test_P4_a_motors_step(row: Floats, m: int, drawn: float, current: float, rate: float) -> None:
    o = at.MOTORS + m * at.MOTOR_SIZE
    before, angle = row[o + at.M_RATE], row[o + at.M_ANGLE]
    assert motor_step(row, m, 24.0, H, at.SUMS_OF_B if m else at.SUMS) == pytest.approx(drawn)
    assert row[o + at.M_CURRENT] == pytest.approx(current) and row[o + at.M_RATE_BEFORE] == before
    assert (row[o + at.M_RATE], row[o + at.M_ANGLE]) == pytest.approx((rate, angle + H * rate))


@pytest.mark.parametrize(("hook", "value", "target", "constant", "extra"), [
    (Hook.COMMAND, 0.25, (18.0 - 3.0) / 2.0, 0.5, 0.0),
    (Hook.COMMAND, 7.0, (24.0 - 3.0) / 2.0, 0.5, 0.0),  # a duty is at most one
    (Hook.COMMAND, -7.0, -3.0 / 2.0, 0.5, 0.0),  # and at least nothing: the diode stops the current
    (Hook.CONSTANT, 0.2, (12.0 - 0.6 * 6.0) / 2.0, 0.6, 0.0),
    (Hook.MOTOR_TORQUE, 0.3, 4.5, 0.5, 0.3),
])  # fmt: skip
def test_P6_effects_on_a_motor(
    row: Floats, hook: Hook, value: float, target: float, constant: float, extra: float
) -> None:
    mean = max(0.0, target + (2.0 - target) * 0.75)
    row[at.SUMS + hook] = value
    motor_step(row, 0, 24.0, H, at.SUMS)
    assert row[A + at.M_CURRENT] == pytest.approx(max(0.0, target + (2.0 - target) * 0.5))
    gained = (row[A + at.M_RATE] - 5.0) * 0.02 / H
    assert gained == pytest.approx(constant * mean + extra - 2.13)


def test_P6_a_heated_winding_answers_slower_and_with_less(row: Floats) -> None:
    """One ohm more: 9 V over 3 ohm, time constant 0.01 H / 3 ohm; the mean by the integral."""
    row[at.SUMS + Hook.RESISTANCE] = 1.0
    drawn = motor_step(row, 0, 24.0, H, at.SUMS)
    assert row[A + at.M_CURRENT] == pytest.approx(3.0 - exp(-0.3))
    assert drawn == pytest.approx(0.5 * (3.0 - (1.0 - exp(-0.3)) / 0.3))


@pytest.mark.parametrize(("duties", "m", "current"), [
    ((0.05, 0.05), 0, 1.2 + 0.8 * 0.5),  # both lead: back-EMF of -3 V drives no more than the applied 1.2 V
    ((0.05, 0.05), 1, 1.2 - 0.2 * 0.5), ((0.05, 0.1), 0, 0.6 + 1.4 * 0.5),  # A lags: its duty alone
    ((0.1, 0.05), 1, 0.6 + 0.4 * 0.5), ((0.1, 0.2), 1, 3.9 - 2.9 * 0.5),
])  # fmt: skip
def test_P4_a_dragged_motor_leads_with_the_higher_duty(
    row: Floats, duties: tuple[float, float], m: int, current: float
) -> None:
    row[at.MEAN_DUTY : at.MEAN_DUTY + 2] = duties
    row[A + at.M_RATE], row[A + at.M_RATE_BEFORE] = -6.0, -6.0
    row[B + at.M_RATE], row[B + at.M_RATE_BEFORE] = 6.0, 6.0
    motor_step(row, m, 24.0, H, at.SUMS)
    assert row[at.MOTORS + m * at.MOTOR_SIZE + at.M_CURRENT] == pytest.approx(current)


@pytest.mark.parametrize("m", [0, 1])
def test_P4_a_power_stage_is_fed_with_duty_voltage_and_back_emf(row: Floats, m: int) -> None:
    row[at.WINDING], row[at.DIODE_DROP], row[at.PULSE], row[at.SUMS + Hook.RESISTANCE] = 1.5, 0.7, 5e-3, 0.5
    row[at.SUMS_OF_B + Hook.RESISTANCE], row[at.VALLEY], row[at.VALLEY + 1] = 0.25, 1.5, 0.5
    duty, emf, heated, valley = ((0.5, 3.0, 0.5, 1.5), (0.25, 1.0, 0.25, 0.5))[m]
    expected = stage(row, valley, duty, 24.0, emf, heated, H)
    drawn = motor_step(row, m, 24.0, H, at.SUMS_OF_B if m else at.SUMS)
    current = row[at.MOTORS + m * at.MOTOR_SIZE + at.M_CURRENT]
    assert (row[at.VALLEY + m], current, drawn) == pytest.approx(expected)
    assert row[at.VALLEY + 1 - m] == (0.5, 1.5)[m]


def test_P1_newton_over_one_step_on_a_sagging_supply(row: Floats) -> None:
    """Trains 4.8, an effect 0.45, friction 1 + 4 * 0.25, a stop 10 * 0.2 + 0.25 N m; 2 kg m2: 0.5 rad/s2."""
    row[at.VOLTAGE], row[at.SUPPLY_RESISTANCE] = 26.0, 0.5
    row[at.SUPPLY_CURRENT], row[at.OTHERS_SAG] = 2.0, 1.0
    row[at.STOP_MIDDLE], row[at.STOP_REACH] = 0.5, 0.3
    row[at.STOP_STIFFNESS], row[at.STOP_DAMPING] = 10.0, 1.0
    row[at.SUMS + Hook.AXIS_TORQUE] = 0.45
    axis_step(row, 7 * H, H)
    assert row[at.ACCELERATION] == pytest.approx(0.5) and row[at.FRICTION] == pytest.approx(2.0)
    assert (row[at.RATE], row[at.RATE_BEFORE], row[at.ANGLE]) == pytest.approx((0.2005, 0.2, 1.0002005))
    assert row[at.STRIBECK] == pytest.approx(1.5e-3)
    assert row[at.BRISTLE] == pytest.approx(1.5e-3 - 0.5e-3 * exp(-0.2005 * H / 1.5e-3))
    assert row[at.SUPPLY_CURRENT] == pytest.approx(0.5 * 2.625 + 0.25 * 1.375)
    assert row[at.STEP] == 8.0


@pytest.mark.parametrize(("before", "rate", "direction", "reversed_at"), [
    (0.0, 0.2, 1.0, 1.0), (0.0, -0.2, -1.0, 1.0), (1.0, 0.2, 1.0, 0.5), (-1.0, -0.2, -1.0, 0.5),
    (-1.0, 0.2, 1.0, 1.0), (1.0, -0.2, -1.0, 1.0), (1.0, 0.0, 1.0, 0.5), (0.0, 0.0, 0.0, 1.0),
])  # fmt: skip
def test_a_reversal_is_where_the_rate_changes_its_sign(
    before: float, rate: float, direction: float, reversed_at: float
) -> None:
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.ANGLE], w[at.REVERSED_AT], w[at.DIRECTION], w[at.INERTIA] = H, 1.0, 0.5, before, 1e9
    w[at.RATE] = w[at.RATE_BEFORE] = rate
    w[at.RATIO] = w[at.RESISTANCE] = w[at.ROTOR_INERTIA] = 1.0
    f = at.DECLARED_FRICTION
    w[f + at.F_SIGMA0 : f + at.FRICTION_SIZE] = 1.0
    w[at.STRIBECK] = 1.0
    axis_step(w, 0.0, H)
    assert (w[at.DIRECTION], w[at.REVERSED_AT]) == (direction, reversed_at)
