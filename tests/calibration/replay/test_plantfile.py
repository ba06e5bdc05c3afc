"""Calibrated numbers in a plant file: each in the file's own meaning, and what no log tells."""

from math import sqrt

import pytest

from calibration.finding import Parameter
from calibration.replay.plantfile import calibrate_model
from plant.gears import RATIO
from plant.model import PlantModel, get, load

MODEL = load("low_preload")
PART = MODEL.axes.ra


def made(skip: list[str] | None = None, **numbers: float) -> tuple[PlantModel, list[str]]:
    found = {name: Parameter(value, "unit") for name, value in numbers.items()}
    return calibrate_model(MODEL, "ra", found, "a log", skip or [])


def number(model: PlantModel, path: str) -> float:
    return get(model, f"axes.ra.{path}").si


def test_a_number_is_written_with_the_log_as_its_source() -> None:
    model, remarks = made(coulomb=1.1 * PART.friction.coulomb.si)
    assert remarks == [] and number(model, "friction.coulomb") == pytest.approx(
        1.1 * PART.friction.coulomb.si
    )
    written = get(model, "axes.ra.friction.coulomb")
    assert (written.source, written.unit) == ("fitted to a log", get(MODEL, "axes.ra.friction.coulomb").unit)
    assert model.axes.dec == MODEL.axes.dec


def test_the_inertia_is_that_of_the_load_without_both_rotors() -> None:
    rotors = 2 * PART.motor.rotor_inertia.si * RATIO**2
    assert number(made(inertia=rotors + 900.0)[0], "inertia") == pytest.approx(900.0)
    assert number(made(inertia=rotors - 5.0)[0], "inertia") == pytest.approx(10.0)  # some load is left


def test_the_resistance_is_that_of_the_winding_alone() -> None:
    beside = PART.motor.switch_resistance.si + PART.motor.sense_resistance.si
    assert number(made(resistance=3.0)[0], "motor.resistance") == pytest.approx(3.0 - beside)


def test_the_stiffness_is_that_of_both_trains_and_damping_keeps_its_share_of_the_critical_one() -> None:
    model, _ = made(stiffness=PART.gear.stiffness.si)  # of one train: twice as much of both
    assert number(model, "gear.stiffness") == pytest.approx(2 * PART.gear.stiffness.si)
    assert number(model, "gear.damping") == pytest.approx(sqrt(2) * PART.gear.damping.si)
    assert get(model, "axes.ra.gear.damping").source.endswith("by the rule it was declared by")


def test_the_bristles_damping_keeps_its_share_of_the_passive_bound() -> None:
    """de Wit 1995: sigma1 below 4 sigma2 Fc / (Fs - Fc)."""
    f = PART.friction
    stiction = f.coulomb.si + 2 * (f.stiction.si - f.coulomb.si)
    assert number(made(stiction=stiction)[0], "friction.bristle_damping") == pytest.approx(
        f.bristle_damping.si / 2
    )
    twice = made(viscous=2 * f.viscous.si)[0]
    assert number(twice, "friction.bristle_damping") == pytest.approx(2 * f.bristle_damping.si)
    none = made(stiction=f.coulomb.si)[0]  # without a bound it stays
    assert number(none, "friction.bristle_damping") == f.bristle_damping.si


def test_what_the_log_cannot_tell_stays_as_declared() -> None:
    model, remarks = made(["coulomb"], coulomb=1.0, nonsense=5.0)
    assert (model, remarks) == (MODEL, [])


def test_what_no_plant_can_have_is_said_and_left_out() -> None:
    model, remarks = made(coulomb=1e12)
    assert model == MODEL and remarks == ["coulomb: 1e+12 unit is no number of a plant"]
