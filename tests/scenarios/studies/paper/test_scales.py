"""The log's scales by the paper's numbers, and a drive's currents and duties by Ohm's law."""

from dataclasses import replace

import numpy as np
import pytest

from plant.model import load, with_value
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper import scales
from scenarios.studies.paper.scales import Drive, drive

SHEET = Drive(
    torque_constant=0.5, winding=0.8, switch=0.2, inductance=1e-3, diode_drop=None, rotor=4.0, stiffness=2e7,
    voltage=24.0, split=0.1, ripple=0.3,
)  # fmt: skip
DIODES = replace(SHEET, diode_drop=0.7)


def test_scales_are_those_of_the_paper_and_the_log_format() -> None:
    counts = 4.608e6 * 735 / 30
    assert pytest.approx(360 * 3600 / counts, rel=1e-12) == scales.ENCODER_ARCSEC
    assert pytest.approx(2.296, abs=5e-4) == scales.COUNT_RATE
    assert (scales.CONTROL_PERIOD_S, scales.LOG_PERIOD_S, scales.EFFORT_SCALE) == (0.005, 0.01, 3000)
    assert pytest.approx(5.0 / 1024 / 8 / 0.1, abs=5e-5) == scales.ADC_A_PER_COUNT
    assert pytest.approx(360.48864, abs=1e-5) == scales.GEAR_RATIO
    assert drive(load(LOW)).voltage == 24.0


def test_table_2_is_what_the_declared_plants_have_at_the_axis() -> None:
    """Motor's numbers times the gear ratio, or as they are: one unit for a whole preload."""
    for preload, name in (("low", LOW), ("high", HIGH)):
        friction, printed = load(name).axes.ra.friction, scales.TABLE_2[preload]
        unit = printed["coulomb"] / friction.coulomb.si
        assert printed["stiction"] / friction.stiction.si == pytest.approx(unit)
        assert printed["stribeck_rate"] == pytest.approx(friction.stribeck_rate.si)
        assert printed["viscous"] == pytest.approx(friction.viscous.si)
        assert drive(load(name)).split == 0.1
    assert (scales.TABLE_2["low"]["coulomb"], scales.TABLE_2["low"]["stiction"]) == (229, 621)
    assert (scales.TABLE_2["high"]["coulomb"], scales.TABLE_2["high"]["stiction"]) == (217, 1490)
    assert scales.INERTIA == 1760


@pytest.mark.parametrize(
    ("sheet", "duty", "emf", "amperes", "ohms"),
    [
        (SHEET, 0.5, 2.0, 10.0, 1.0),
        (SHEET, 0.5, -2.0, 12.0, 1.0),  # superposition: what turns it against its pull drives nothing
        (SHEET, 0.0, 2.0, -2.0, 1.0),
        (DIODES, 0.5, 2.0, (0.5 * 24.7 - 0.7 - 2.0) / 0.9, 0.9),
        (DIODES, 0.5, -2.0, (0.5 * 24.7 - 0.7 + 2.0) / 0.9, 0.9),
        (DIODES, 1.0, 0.0, 24.0, 1.0),
        (DIODES, 0.0, -2.7, 2.0 / 0.8, 0.8),  # through the diode, without the switch
    ],
)
def test_the_current_that_a_duty_leads_to(
    sheet: Drive, duty: float, emf: float, amperes: float, ohms: float
) -> None:
    current, resistance = sheet.tends(np.array([duty]), np.array([emf]))
    assert current[0] == pytest.approx(amperes) and resistance[0] == pytest.approx(ohms)


def test_a_steady_duty_gives_both_motors_the_torque_that_is_asked_for() -> None:
    emf, torque = np.array([0.0, 1.0, 4.0]), np.array([0.2, 1.5, 3.0])
    duty = SHEET.steady(torque, emf)
    # lead (24 d - e) / R less lag 0.1 x 24 d / R, times 0.5 N m/A; R = 1 ohm
    assert duty == pytest.approx((torque / 0.5 + emf) / (24.0 * 0.9), rel=1e-6)
    strong = DIODES.steady(np.array([1.0]), np.array([0.0]))
    lead = (strong * 24.7 - 0.7) / (0.8 + 0.2 * strong)  # the other's duty is below its diode's drop
    assert 0.5 * lead == pytest.approx([1.0], rel=1e-6) and 0.1 * strong[0] * 24.7 < 0.7


def test_a_steady_duty_stays_between_nothing_and_everything() -> None:
    nothing, all_of_it = SHEET.steady(np.array([-1.0, 1e6]), np.zeros(2))
    assert 0.0 < nothing < 1e-8 and all_of_it == 1.0


def test_a_plants_drive_is_its_data_sheet_at_the_axis() -> None:
    plant = with_value(load(LOW), "axes.ra.motor.diode_drop", 0.7)
    motor, found = plant.axes.ra.motor, drive(plant)
    assert found.torque_constant == motor.torque_constant.si and found.inductance == motor.inductance.si
    assert found.winding == motor.resistance.si and found.winding + found.switch == pytest.approx(motor.loop)
    assert found.rotor == pytest.approx(motor.rotor_inertia.si * 360.48864**2)
    assert 2.0 * found.stiffness == pytest.approx(plant.axes.ra.gear.stiffness.si)
    frequency = plant.controller.pwm_frequency.si
    assert found.diode_drop == 0.7
    assert found.ripple == pytest.approx(24.7 / 2 / motor.inductance.si / frequency)


def test_without_diodes_the_ripple_is_that_of_the_supply() -> None:
    plant = load("low_preload")
    found = drive(plant)
    assert found.diode_drop is None
    swing = found.ripple * 2 * plant.axes.ra.motor.inductance.si * plant.controller.pwm_frequency.si
    assert swing == pytest.approx(24.0)
