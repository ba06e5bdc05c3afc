"""The torque constant from volts where the axis leaps and its motor does not: the train unwinds."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.balances.electrical import electrical_problem
from calibration.balances.frame import Frame
from calibration.balances.motion import motion_of
from calibration.balances.torque import WIDTH
from calibration.inputs.declaredplant import Declared
from calibration.inputs.rigfile import telescope

DT, ROWS, FINE = 0.01, 24_000, 10  # s, rows, steps of the drive per row
V, R, K, RATIO, STIFFNESS = 24.0, 2.385, 0.39, 360.49, 3.08e6  # hardware.md 1.2, 2.3, 2.4
SHARE = 0.1  # counter torque, of the effort
LEAP = 1e-4  # rad that the axis stands behind before it goes
DECLARED = Declared(
    coulomb=229.0,
    stiction=621.0,
    stribeck_rate=4e-4,
    viscous=6700.0,
    bristle_stiffness=5.9e6,
    stiffness=STIFFNESS,
    torque_constant=K,
    resistance=R,
)


def constant(stiffness: float) -> float:
    """What the channel says of K when it is told this stiffness."""
    t = DT / FINE * np.arange(ROWS * FINE)
    phase = t / 4.0 + 0.5 * np.sin(2 * np.pi * t / 61.0)  # leaps of some 0.3 s every few seconds
    leap = (np.floor(phase) + 1 / (1 + np.exp(-((phase % 1.0) - 0.5) * 40.0))) * LEAP
    current = 1.2 - STIFFNESS / (K * RATIO) * (leap - LEAP * phase)  # held back, the motor winds up its train
    assert current.min() > 0.1
    axis = leap + 2e-5 * t
    spin = RATIO * np.gradient(axis + K * RATIO * current / STIFFNESS, DT / FINE)
    effort = (R * current + K * spin) / V
    lagging = SHARE * effort * V / R
    columns = {"effort": effort, "position": axis, "current_a": current, "current_b": lagging}
    columns = {name: column[::FINE] for name, column in columns.items()}  # what a log has of it
    scale = {
        "gear_ratio": RATIO,
        "supply_V": V,
        "counter_torque": SHARE,
        "adc_A_per_count": 0.0061,
    }
    scale |= {"effort_full_scale": 3000.0, "adc_end_A": np.inf}
    zero = np.zeros(ROWS, dtype=np.int64)
    frame = Frame(
        runs=[],
        period_s=DT,
        t=t[::FINE],
        clock=np.zeros(ROWS),
        run=zero,
        session=zero,
        columns=columns,
        scale=scale,
        rig=telescope("ra"),
    )
    m = motion_of(frame, WIDTH)
    found = electrical_problem(frame, m, zero > 0, replace(DECLARED, stiffness=stiffness))
    assert found is not None
    return found.windings.constant


def test_the_constant_is_right_though_the_axis_leaps() -> None:
    assert constant(STIFFNESS) == pytest.approx(K, rel=0.003)
    assert abs(constant(1e3 * STIFFNESS) / K - 1) > 0.01  # of a rigid train it would not be
