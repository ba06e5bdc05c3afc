"""What the sensors show, from a row with another number in every place that is read; values by hand."""

import numpy as np
import pytest

from plant.compiled import Floats
from plant.effects.signals import Hook
from plant.kernels import layout as at
from plant.kernels.readings import keep, read, record
from plant.plant import Plant
from tests.plant.bench import bare

GIVEN = {
    at.INCREMENTAL_SCALE: 10.0, at.ABSOLUTE_SCALE: 1000.0, at.AUXILIARY_SCALE: 4000.0, at.TACH_SCALE: 100.0,
    at.SUMS + Hook.INCREMENTAL: 0.25, at.SUMS + Hook.ABSOLUTE: -0.5, at.SUMS + Hook.AUXILIARY: 1.0,
    at.SUMS + Hook.CURRENT: 0.125, at.SUMS_OF_B + Hook.CURRENT: 0.0625,
}  # fmt: skip
MOTORS = ((20.0, 3.0, 1.5, 0.25, 0.5, 11.0), (30.0, -4.0, 2.5, 0.5, 2.0, -12.0))
"""Angle, rate, zero of the tachometer, duty, current, torque of the train."""


@pytest.fixture
def row() -> Floats:
    w = np.zeros(at.WIDTH)
    w[at.GRID], w[at.RATE], w[at.ANGLE], w[at.INCREMENTAL_ZERO], w[at.RIPPLE] = 2e-3, 0.5, 7.0, 2.0, 0.8
    w[at.FRICTION], w[at.BRISTLE] = 40.0, 5e-5
    for place, value in GIVEN.items():
        w[place] = value
    for m, (angle, rate, zero, duty, current, gear) in enumerate(MOTORS):
        o = at.MOTORS + m * at.MOTOR_SIZE
        w[o : o + at.MOTOR_SIZE] = rate, angle, 0.0, current, gear
        w[at.TACH_ZERO + m], w[at.DUTY + m] = zero, duty
    return w


def test_P7_readings_are_of_the_grid_point_and_currents_of_the_ripples_peak(row: Floats) -> None:
    """Angles lie half a step (1 ms) behind the grid point, so that one is at 7 - 0.5 mrad."""
    read(row)
    value, slope = row[at.OUT : at.OUT + 12 : 2], row[at.OUT + 1 : at.OUT + 12 : 2] * 1e9
    assert value[:3] == pytest.approx([(6.9995 + 0.25 - 2.0) * 10.0, 6499.5, 7.9995 * 4000.0])
    assert value[3:] == pytest.approx([(19.997 - 1.5) * 100.0, (30.004 - 2.5) * 100.0, 6.9995])
    assert slope == pytest.approx([5.0, 500.0, 2000.0, 300.0, -400.0, 0.5])
    currents = row[at.OUT + at.OUT_CURRENT_A : at.OUT + at.OUT_SIZE]
    assert currents == pytest.approx([0.5 + 0.8 * 0.25 * 0.75 + 0.125, 2.0 + 0.8 * 0.25 + 0.0625])
    for m in range(2):
        row[at.MOTORS + m * at.MOTOR_SIZE + at.M_CURRENT] = 0.0
    read(row)
    assert currents == pytest.approx([0.125, 0.0625])  # none flows, none ripples


def test_P7_a_power_stages_current_is_that_of_the_switchs_opening(row: Floats) -> None:
    """i + (V - K w - R i) times the closed time over the inductance: 24 V, 0.5 V s, 2 ohm, 0.01 A/V."""
    row[at.VOLTAGE], row[at.TORQUE_CONSTANT], row[at.RESISTANCE] = 24.0, 0.5, 2.0
    row[at.PULSE], row[at.INDUCTANCE], row[at.VALLEY], row[at.VALLEY + 1] = 0.01, 1e-3, 0.5, 1.0
    read(row)
    currents = row[at.OUT + at.OUT_CURRENT_A : at.OUT + at.OUT_SIZE]
    first = 0.5 + (24.0 - 1.5 - 1.0) * 0.25 * 0.01
    second = 1.0 + (24.0 - 2.0 - 2.0) * 0.5 * 0.01  # B turns its own way at -4 rad/s
    assert currents == pytest.approx([first + 0.125, second + 0.0625])


def test_kept_readings_lie_where_the_step_says(row: Floats) -> None:
    row[at.STEP] = at.DELAY_ROWS + 3
    row[at.OUT : at.OUT + at.OUT_SIZE] = range(1, at.OUT_SIZE + 1)
    keep(row)
    ring = row[at.DELAYS : at.DELAYS + at.DELAY_ROWS * at.OUT_SIZE].reshape(-1, at.OUT_SIZE)
    assert ring[3].tolist() == list(range(1, at.OUT_SIZE + 1)) and np.count_nonzero(ring) == at.OUT_SIZE


def test_a_row_of_truth_is_of_the_grid_point(row: Floats) -> None:
    row[at.RECORDED] = at.TRUTH_ROWS + 2
    o = at.MOTORS + at.MOTOR_SIZE + at.M_CURRENT
    row[o] = 1.25
    record(row, 9.0)
    ring = row[at.TRUTH : at.TRUTH + at.TRUTH_ROWS * at.TRUTH_SIZE].reshape(-1, at.TRUTH_SIZE)
    told = dict(zip(at.TRUTH_COLUMNS, ring[2], strict=True))
    assert told == pytest.approx(
        {
            "t": 9.0, "angle": 6.9995, "rate": 0.5, "current_a": 0.5, "current_b": 1.25,
            "motor_angle_a": 19.997, "motor_angle_b": 30.004, "gear_torque_a": 11.0, "gear_torque_b": -12.0,
            "friction": 40.0, "bristle": 5e-5,
        }
    )  # fmt: skip
    assert row[at.RECORDED] == at.TRUTH_ROWS + 3 and np.count_nonzero(ring) == at.TRUTH_SIZE


def test_P8_both_tachometers_wake_up_within_a_count_of_their_own() -> None:
    """Each encoder's fraction of a count is another one."""
    w = Plant(bare(), 1).world[0]
    parts = []
    for m in range(2):
        zero = w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE] - w[at.TACH_ZERO + m]
        parts.append(zero * w[at.TACH_SCALE])
    assert all(0.0 <= part < 1.0 for part in parts) and abs(parts[0] - parts[1]) > 1e-3
