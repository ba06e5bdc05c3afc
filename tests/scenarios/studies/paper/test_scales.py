"""Scales of the paper by its own arithmetic; the drive's currents and duties by Ohm's law."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from plant.model import with_value
from scenarios.studies.paper import scales
from scenarios.studies.paper.scales import Drive, drive
from tests.scenarios.studies.paper.bench import LOW, near

SHEET = Drive(
    torque_constant=0.5, winding=2.0, switch=0.5, inductance=1e-3, diode_drop=None, rotor=1.0, stiffness=1.0,
    voltage=24.0, split=0.1, ripple=0.1,
)  # fmt: skip


def test_scales_are_the_papers() -> None:
    assert pytest.approx(360 * 3600) == 4.608e6 * 735 / 30 * scales.ENCODER_ARCSEC
    assert pytest.approx(2.2959, abs=1e-4) == scales.COUNT_RATE  # arcsec/s: a count in 5 ms
    assert scales.CONTROL_PERIOD_S * 2 == scales.LOG_PERIOD_S == 0.01
    assert pytest.approx(5.0 / 1024 / 8 / 0.1, rel=2e-3) == scales.ADC_A_PER_COUNT
    assert pytest.approx(113 * 123 * 250 / (27 * 21 * 17)) == scales.GEAR_RATIO
    assert scales.EFFORT_SCALE == 3000 and scales.INERTIA == 1760
    assert scales.TABLE_2["low"] == {"viscous": 6700, "coulomb": 229, "stiction": 621, "stribeck_rate": 4e-4}
    high = {"viscous": 11300, "coulomb": 217, "stiction": 1490, "stribeck_rate": 7e-4}
    assert scales.TABLE_2["high"] == high


def test_mean_voltages_drive_a_current_and_a_generator_none() -> None:
    """(0.5 24 - emf) / 2.5 ohm, of a motor that is turned against its pull 12 / 2.5."""
    current, resistance = SHEET.tends(np.array([0.5, 0.5]), np.array([2.0, -2.0]))
    assert current == pytest.approx([4.0, 4.8]) and resistance == pytest.approx([2.5, 2.5])


def test_a_diode_drops_while_the_switch_is_open_and_a_generator_drives() -> None:
    """D 24 - (1 - D) 1 - emf volts over 2 ohm and D times 0.5."""
    sheet = replace(SHEET, diode_drop=1.0)
    current, resistance = sheet.tends(np.array([0.5, 0.2]), np.array([2.0, -2.0]))
    assert current == pytest.approx([(12 - 0.5 - 2) / 2.25, (4.8 - 0.8 + 2) / 2.1])
    assert resistance == pytest.approx([2.25, 2.1])


@given(st.floats(0.05, 0.9), st.floats(0.0, 3.0), st.sampled_from([None, 0.8]))
def test_the_steady_duty_gives_its_torque(duty: float, emf: float, drop: float | None) -> None:
    """The torque of both motors at a duty leads back to it."""
    sheet = replace(SHEET, diode_drop=drop)
    lead, lag = (
        max(0.0, float(sheet.tends(np.array([part]), np.array([sign * emf]))[0][0]))
        for part, sign in ((duty, 1.0), (0.1 * duty, -1.0))
    )
    if lead > 0.0:
        found = sheet.steady(np.array([0.5 * (lead - lag)]), np.array([emf]))
        if lead > lag:
            assert found == pytest.approx([duty], abs=2e-9)


def test_a_torque_that_no_duty_gives_asks_for_all() -> None:
    assert SHEET.steady(np.array([1e3, 0.0]), np.array([0.0, 0.0])) == pytest.approx([1.0, 0.0], abs=2e-9)


@pytest.mark.parametrize("drop", [None, 0.7])
def test_a_plant_s_sheet_is_reflected_to_the_axis(drop: float | None) -> None:
    motor, axis = LOW.axes.ra.motor, LOW.axes.ra
    if drop is None:
        plant = replace(LOW, axes=replace(LOW.axes, ra=replace(axis, motor=replace(motor, diode_drop=None))))
    else:
        plant = with_value(LOW, "axes.ra.motor.diode_drop", drop)
    made = drive(plant)
    hertz = LOW.controller.pwm_frequency.si
    assert made == Drive(
        torque_constant=motor.torque_constant.si, winding=motor.resistance.si,
        switch=near(motor.loop - motor.resistance.si),
        inductance=motor.inductance.si, diode_drop=drop,
        rotor=near(motor.rotor_inertia.si * scales.GEAR_RATIO**2),
        stiffness=axis.gear.stiffness.si / 2, voltage=24.0, split=near(0.1),
        ripple=near((24.0 + (drop or 0.0)) / (2 * motor.inductance.si * hertz)),
    )  # fmt: skip
    assert made.winding + made.switch == pytest.approx(motor.loop)
