"""Lines as a plant file has them: what the motors had to add, the drive takes."""

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import stage_of_wave
from calibration.names import NAMES
from calibration.names.inplant import Facts
from plant.effects import REGISTRY
from plant.effects.signals import ANGLE, MOTOR, MOTOR_ANGLE
from plant.evaluate import evaluate, signals
from plant.gears import ORDERS
from plant.parts import EffectModel
from plant.rows import values

ROWS = 400
PHASE = 0.7
LINES = {
    "gear_eccentricity": ("shaft2", 2, 2 * ORDERS["shaft2"]),
    "gear_mesh": ("mesh3", 1, ORDERS["mesh3"]),
    "gravity_imbalance": ("axis", 1, 1.0),
    "bearing_pass": (None, None, 437.3),
    "motor_cogging": ("motor", 20, 20.0),
    "torque_ripple": ("motor", 12, 12.0),
}


def written(name: str, **more: float) -> list[EffectModel]:
    """A found line of the torque, A cos(order x + phase), in a plant file."""
    stage, harmonic, order = LINES[name]
    size = "ripple" if name == "torque_ripple" else "amplitude"
    parameters = {size: Parameter(0.1, ""), "phase": Parameter(PHASE, "rad")}
    parameters |= {key: Parameter(x, "") for key, x in more.items()}
    domain = REGISTRY[name].domain
    f = Finding(name, "T", domain, stage=stage, harmonic=harmonic, order=order, parameters=parameters)
    return NAMES[name].to_plant(f, Facts("log")).effects


@pytest.mark.parametrize("name", LINES)
def test_the_plant_takes_what_the_motors_gave(name: str) -> None:
    x = np.linspace(0.0, 2.0, ROWS)
    (effect,) = written(name, motor=1.0) if name in ("motor_cogging", "torque_ripple") else written(name)
    given = signals(ROWS, {ANGLE: x, MOTOR_ANGLE: x, MOTOR: np.zeros(ROWS)})
    made = evaluate(name, given, values(effect))
    assert made == pytest.approx(-0.1 * np.cos(LINES[name][2] * x + PHASE), abs=1e-9)


def test_two_waves_of_both_motors_are_two_effects() -> None:
    a, b = written("motor_cogging", amplitude_2=0.2, phase_2=-0.4)
    assert [values(e)["motor"] for e in (a, b)] == [1.0, 2.0]
    assert [values(e)["amplitude"] for e in (a, b)] == pytest.approx([0.1, 0.2])


def test_a_motor_that_the_log_does_not_tell_is_both_with_a_remark() -> None:
    (one,) = written("motor_cogging")
    assert values(one)["motor"] == 0.0


def test_waves_of_torque_over_an_angle() -> None:
    assert {e.name for e in REGISTRY.values() if e.wave} == {*LINES, "position_friction"}


@pytest.mark.parametrize(
    ("effect", "place"),
    [
        (EffectModel("gear_eccentricity", "roller", 2), "roller"),
        (EffectModel("gear_mesh", "mesh1"), "mesh1"),
        (EffectModel("gravity_imbalance"), "axis"),
        (EffectModel("bearing_pass"), None),
        (EffectModel("motor_cogging"), None),
        (EffectModel("position_friction", "shaft2"), None),
        (EffectModel("damaged_tooth", "shaft2"), None),
    ],
)
def test_declared_waves_have_a_known_order_over_the_axis(effect: EffectModel, place: str | None) -> None:
    assert stage_of_wave(effect) == place
