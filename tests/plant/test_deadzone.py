"""What a PWM step does at small duties, against the circuit switch by switch."""

import pytest

from plant import model
from plant.deadzone import bias_steps, dead_zone, step_amperes
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
