"""From the numbers of an axis to its row: the paper's formulas by hand, each number another one."""

from math import exp, pi

import numpy as np
import pytest

from plant.compiled import Floats
from plant.kernels import layout as at
from plant.world import Numbers, prepare

RATIO = 113 / 27 * 123 / 21 * 250 / 17
NUMBERS = Numbers(
    grid=5e-4, voltage=24.0, temperature=12.0, warming=1e-3, pwm_frequency=20e3, inertia=1700.0,
    stiffness=3e6, damping=400.0, backlash=0.002, bristle_stiffness=6e6, bristle_damping=3000.0,
    viscous=6700.0, coulomb=229.0, stiction=621.0, stribeck_rate=4e-4, stribeck_exponent=2.0,
    bristle_decay=1e-3, torque_constant=0.4, resistance=2.2, inductance=2.7e-3, rotor_inertia=3e-3, drag=1e-4,
    switch_resistance=0.085, sense_resistance=0.1, incremental=4.6e6, roller_ratio=24.5, absolute=29.0,
    auxiliary=17.0, auxiliary_ratio=10.8, tachometer=4096.0, diode=0.25, diode_drop=0.9, stage_drop=0.0,
    compliance=1e-7, swinging=40.0, angle=0.3, incremental_phase=0.25, phase_a=0.125, phase_b=0.75,
)  # fmt: skip


def row(**changed: float) -> Floats:
    w = np.zeros(at.WIDTH)
    prepare(w, NUMBERS._replace(**changed))
    return w


def test_parameters_of_an_axis() -> None:
    w, loop, turn = row(), 2.2 + 0.085 + 0.1, 2.0 * pi
    decay = exp(-loop * 5e-4 / 2.7e-3)
    expected = {
        at.GRID: 5e-4, at.INERTIA: 1660.0, at.ROTOR_INERTIA: 3e-3, at.RATIO: RATIO, at.GEAR_DAMPING: 200.0,
        at.GEAR_STIFFNESS: 0.5 * 3e6 / (1.0 + 3e6 * 1e-7),  # springs in series, half on either train
        at.HALF_PLAY: 0.001, at.RESISTANCE: loop, at.WINDING: 2.2, at.INDUCTANCE: 2.7e-3, at.VOLTAGE: 24.0,
        at.TORQUE_CONSTANT: 0.4, at.ROTOR_DRAG: 1e-4, at.CURRENT_DECAY: decay,
        at.CURRENT_BLEND: (1.0 - decay) / (loop * 5e-4 / 2.7e-3),  # mean of an exponential over a step
        at.RIPPLE: 24.0 / (2.0 * 2.7e-3 * 20e3), at.DIODE: 0.25, at.DIODE_DROP: 0.9, at.PULSE: 0.0,
        at.TEMPERATURE: 12.0, at.WARMING: 1e-3, at.STRIBECK: 621.0 / 6e6,
        at.INCREMENTAL_SCALE: 4.6e6 * 24.5 / turn, at.ABSOLUTE_SCALE: 2.0**29 / turn,
        at.AUXILIARY_SCALE: 10.8 * 2.0**17 / turn, at.TACH_SCALE: 4096.0 / turn,
    }  # fmt: skip
    assert {place: w[place] for place in expected} == pytest.approx(expected, rel=1e-12)
    friction = w[at.DECLARED_FRICTION : at.DECLARED_FRICTION + at.FRICTION_SIZE]
    assert friction.tolist() == [6e6, 3000.0, 6700.0, 229.0, 621.0, 4e-4, 2.0, 1e-3]


def test_P4_a_declared_drop_makes_the_power_stage() -> None:
    w = row(stage_drop=0.7)
    assert w[at.DIODE_DROP] == 0.7 and w[at.PULSE] == pytest.approx(50e-6 / 2.7e-3)


def test_an_axis_begins_at_rest_with_teeth_in_contact_and_each_counter_within_a_count() -> None:
    w = row()
    assert w[at.ANGLE] == w[at.REVERSED_AT] == 0.3 and w[at.RATE] == 0.0
    assert (w[at.ANGLE] - w[at.INCREMENTAL_ZERO]) * w[at.INCREMENTAL_SCALE] == pytest.approx(0.25, abs=1e-6)
    for m, (angle, phase) in enumerate(((0.301, 0.125), (0.299, 0.75))):
        motor = w[at.MOTORS + m * at.MOTOR_SIZE + at.M_ANGLE]
        assert motor == pytest.approx(RATIO * angle, rel=1e-12)
        assert (motor - w[at.TACH_ZERO + m]) * w[at.TACH_SCALE] == pytest.approx(phase, abs=1e-9)
    assert np.count_nonzero(w[at.RATE : at.DUTY]) == 5  # four angles and g; nothing moves
