"""Effects put into a plant file behind those it has: what is taken, what is refused, and what is said."""

from pathlib import Path

import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.declaredplant import PATHS
from calibration.names import NAMES
from calibration.names.inplant import Facts, Made
from calibration.replay import plantfile
from calibration.replay.plantfile import calibrate_model, convert, correct, write_plant
from plant.model import default_files, get, load, with_effects
from tests.calibration.logs import effect

MESH = effect("gear_mesh", "mesh3", amplitude=(12.0, "N m"), phase=(0.7, "rad"))
MODEL = with_effects(load(default_files()["low_preload"]), "ra", [MESH])
FACTS = Facts("a log", "ra")
DRAG = Finding("brake_drag", "T", "time")


def made(monkeypatch: pytest.MonkeyPatch, *answers: Made) -> tuple[list[str], list[str], float]:
    """Names of the effects, remarks, and the inertia."""
    given = iter(answers)
    monkeypatch.setattr(plantfile, "convert", lambda f, facts: next(given))
    model, remarks = correct(MODEL, "ra", [DRAG] * len(answers), FACTS)
    assert model.axes.dec == MODEL.axes.dec
    return [e.name for e in model.axes.ra.effects], remarks, get(model, "axes.ra.inertia").si


INERTIA = MODEL.axes.ra.inertia.si


def test_effects_stand_behind_those_there_are(monkeypatch: pytest.MonkeyPatch) -> None:
    drag = effect("brake_drag", torque=(20.0, "N m"), start=(10.0, "s"))
    names, remarks, inertia = made(monkeypatch, Made(effects=[drag]), Made(effects=[MESH], remarks=["so"]))
    assert names == ["gear_mesh", "brake_drag", "gear_mesh"] and remarks == ["so"] and inertia == INERTIA


def test_an_effect_beyond_its_bounds_is_left_out_and_said(monkeypatch: pytest.MonkeyPatch) -> None:
    wild = effect("brake_drag", torque=(1e12, "N m"), start=(10.0, "s"))
    names, remarks, _ = made(monkeypatch, Made(effects=[wild]))
    assert names == ["gear_mesh"] and len(remarks) == 1
    assert remarks[0].startswith("brake_drag left out of the plant: ") and "torque" in remarks[0]


def test_a_changed_number_is_added_and_one_beyond_its_bounds_said(monkeypatch: pytest.MonkeyPatch) -> None:
    assert made(monkeypatch, Made(numbers={"inertia": 5.0}))[2] == pytest.approx(INERTIA + 5.0)
    both = made(monkeypatch, Made(numbers={"inertia": 5.0}), Made(numbers={"inertia": -1e12}))
    assert both[1] == ["brake_drag: inertia cannot be changed by -1e+12"] and both[2] == pytest.approx(
        INERTIA + 5.0
    )


def test_a_declared_number_that_is_an_effect_is_said_with_its_place() -> None:
    named = ((n, x.changed) for n, x in NAMES.items() if x.changed is not None)
    name, changed = next((n, c) for n, c in named if "coulomb" in c.numbers)
    found = convert(Finding(name, "T", "velocity"), Facts("a log", "dec"))
    paths = " and ".join(PATHS[number] for number in changed.numbers)
    assert found == Made(remarks=[f"{name}: in the plant as axes.dec.{paths}"])


def test_the_plant_is_written_as_it_is_read_again(tmp_path: Path) -> None:
    out = tmp_path / "plant.yaml"
    stiff = {
        "coulomb": Parameter(1.05 * MODEL.axes.ra.friction.coulomb.si, "N m"),
        "viscous": Parameter(1e9, "x"),
    }
    model, remarks = write_plant(out, MODEL, stiff, [], FACTS, [])
    assert load(out) == model and remarks == ["viscous: 1e+09 x is no number of a plant"]
    assert get(model, "axes.ra.friction.coulomb").si == pytest.approx(stiff["coulomb"].value)
    assert write_plant(out, MODEL, stiff, [], FACTS, ["viscous", "coulomb"])[1] == []


def test_every_number_is_written_where_the_plant_has_it() -> None:
    part = MODEL.axes.ra
    given = {
        "viscous": 1.01 * part.friction.viscous.si, "stribeck_speed": 1.01 * part.friction.stribeck_rate.si,
        "sigma_0": 1.01 * part.friction.bristle_stiffness.si,
        "torque_constant": 1.01 * part.motor.torque_constant.si,
    }  # fmt: skip
    model, remarks = calibrate_model(
        MODEL, "ra", {k: Parameter(x, "") for k, x in given.items()}, "a log", []
    )
    paths = (
        "friction.viscous",
        "friction.stribeck_rate",
        "friction.bristle_stiffness",
        "motor.torque_constant",
    )
    assert [get(model, f"axes.ra.{p}").si for p in paths] == pytest.approx(
        list(given.values())
    ) and remarks == []
