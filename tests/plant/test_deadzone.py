"""What a PWM step does at small duties, against the circuit switch by switch."""

import pytest

from plant import model
from plant.deadzone import bias_steps, dead_zone, drop_v, ohms, step_amperes, step_torque
from tests.plant.bench import changed
from tests.plant.stage import Circuit, run

STEPS, PERIODS = 3000, 3000


def circuit(plant: model.PlantModel) -> Circuit:
    motor = plant.axes.ra.motor
    return Circuit(24.0, 0.7, motor.resistance.si, 0.185, motor.inductance.si, 50e-6)


@pytest.mark.parametrize("inductance_mh", [2.0, 2.72, 20.0])
def test_P4_below_the_dead_zone_the_current_dies_in_every_period_and_above_it_does_not(
    inductance_mh: float,
) -> None:
    plant = changed(model.load("low_preload_bridge"), motor__inductance=inductance_mh)
    zone = dead_zone(plant, plant.axes.ra.motor)
    for share, flows in ((0.985, False), (1.015, True)):
        assert (run(circuit(plant), share * zone, 0.0, 0.0, PERIODS)[0] > 0.0) is flows


def test_P4_beyond_it_a_step_is_worth_what_is_said() -> None:
    plant = model.load("low_preload_bridge")
    means = [run(circuit(plant), steps / STEPS, 0.0, 0.0, PERIODS)[1] for steps in (120, 160)]
    assert (means[1] - means[0]) / 40 == pytest.approx(step_amperes(plant, plant.axes.ra.motor), rel=0.05)


def test_P4_the_bias_is_beyond_all_that_may_be_lost() -> None:
    plant = model.load("low_preload_bridge")
    assert bias_steps(plant, plant.axes.ra.motor) == round(1.2 * (85.4 + 30.0))
    without = model.load("low_preload")
    assert dead_zone(without, without.axes.ra.motor) == 0.0
    assert bias_steps(without, without.axes.ra.motor) == 36


def test_a_current_that_always_dies_is_an_error() -> None:
    """R / (2 L f) of 1: a ripple as large as the supply."""
    ohm = model.load("low_preload_bridge").axes.ra.motor.resistance.si
    limit_mh = 1000 * ohm / (2 * 20e3)
    for inductance_mh, good in ((limit_mh * 1.001, True), (limit_mh * 0.999, False)):
        plant = changed(model.load("low_preload_bridge"), motor__inductance=inductance_mh)
        if good:
            assert dead_zone(plant, plant.axes.ra.motor) > 0.9
            continue
        with pytest.raises(ValueError, match="the current dies at every duty"):
            dead_zone(plant, plant.axes.ra.motor)


def test_the_dead_zone_by_its_formula() -> None:
    """(D (V + d) - d) / R is half of D V / (2 L f): D = d / (V + d - V R / (2 L f))."""
    plant = model.load("low_preload_bridge")
    motor = plant.axes.ra.motor
    ripple = 24.0 * 0.495 / (2 * 2.72e-3 * 20e3)
    assert dead_zone(plant, motor) == pytest.approx(0.7 / (24.7 - ripple))
    assert (drop_v(motor), ohms(motor)) == (0.7, 0.495)
    assert step_amperes(plant, motor) == pytest.approx(24.7 / 0.495 / 3000)
    assert step_torque(plant, motor) == pytest.approx(24.7 / 0.495 / 3000 * 0.44 * 360.488748, rel=1e-6)
    plain = model.load("low_preload")
    motor = plain.axes.ra.motor
    assert (drop_v(motor), ohms(motor)) == (0.0, pytest.approx(2.385))
    assert step_amperes(plain, motor) == pytest.approx(24.0 / 2.385 / 3000)
