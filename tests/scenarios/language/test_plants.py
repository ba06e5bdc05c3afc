"""The plant that a scenario asks for: its file, effects by axis, errors of the mount, numbers overridden."""

from pathlib import Path
from typing import Any

import pytest

from plant.model import dump, load
from scenarios.language.document import ScenarioError
from scenarios.language.plants import named, plant_model

COULOMB, STICTION = "axes.ra.friction.coulomb", "axes.ra.friction.stiction"
LOW = load("low_preload")


def made(**given: Any) -> Any:
    return plant_model({"file": "low-preload", **given}, Path("nowhere"))


def effects(model: Any, axis: str) -> list[str]:
    return [each.name for each in getattr(model.axes, axis).effects]


def test_a_name_is_a_file() -> None:
    block = {"file": "x", "effects": []}
    assert named("x") == {"file": "x"} and named(block) is block


@pytest.mark.parametrize("name", ["low-preload", "low_preload"])
def test_a_plant_that_comes_along_goes_by_its_name(name: str) -> None:
    assert plant_model({"file": name}, Path("nowhere")).axes == LOW.axes


def test_a_file_is_looked_for_here_and_beside_the_scenario(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    beside, here = tmp_path / "beside", tmp_path / "here"
    for folder, preload in ((beside, "low_preload"), (here, "high_preload")):
        folder.mkdir()
        dump(load(preload), folder / "mine.yaml")
    assert plant_model({"file": "mine.yaml"}, beside).name == LOW.name
    monkeypatch.chdir(here)
    assert plant_model({"file": "mine.yaml"}, beside).name == load("high_preload").name


@pytest.mark.parametrize(("name", "words"), [
    ("mine.yaml", "plant: mine.yaml: no such file"),
    ("low-prelod", "plant: 'low-prelod' is not known; did you mean 'low_preload'?"),
])  # fmt: skip
def test_a_plant_that_is_not_there_is_named(name: str, words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        plant_model({"file": name}, Path("nowhere"))
    assert str(caught.value).startswith(words)


def test_effects_are_added_to_both_axes_or_to_one() -> None:
    model = made(effects=["motor_cogging", {"name": "torque_ripple", "axis": "dec"}])
    assert effects(model, "ra") == [*effects(LOW, "ra"), "motor_cogging"]
    assert effects(model, "dec") == [*effects(LOW, "dec"), "motor_cogging", "torque_ripple"]
    assert effects(made(), "ra") == effects(LOW, "ra")


def test_parameters_of_an_effect_are_in_its_own_unit_or_in_one_that_is_told() -> None:
    block = {"name": "gear_mesh", "stage": "mesh2", "parameters": {"amplitude": 3.5}}
    (found,) = made(effects=[block]).axes.ra.effects[len(LOW.axes.ra.effects) :]
    amplitude = found.parameters["amplitude"]
    assert (found.name, found.stage, amplitude.value) == ("gear_mesh", "mesh2", 3.5)
    assert amplitude.source == "scenario"
    block["parameters"] = {"amplitude": {"value": 2.0, "source": "measured"}}
    (told,) = made(effects=[block]).axes.ra.effects[len(LOW.axes.ra.effects) :]
    assert (told.parameters["amplitude"].value, told.parameters["amplitude"].source) == (2.0, "measured")
    assert told.parameters["amplitude"].unit == amplitude.unit


@pytest.mark.parametrize(("effect", "words"), [
    ({"name": "gear_mash"}, "gear_mash"), ({"name": "motor_cogging", "parameters": {"none": 1.0}}, "none"),
    ({"name": "gear_mesh"}, "stage: missing"), ({"name": "motor_cogging", "stage": "mesh2"}, "stage"),
])  # fmt: skip
def test_an_effect_that_cannot_be_is_one_line(effect: dict[str, Any], words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        made(effects=[effect])
    assert str(caught.value).startswith("plant: ") and words in str(caught.value)
    assert "\n" not in str(caught.value)


def test_a_mount_has_errors_unless_it_shall_have_none() -> None:
    assert made().mount is not None and made(mount=True).mount is not None and made(mount=False).mount is None


def test_a_number_is_overridden_and_says_so() -> None:
    model = made(overrides={COULOMB: 100.0})
    coulomb = model.axes.ra.friction.coulomb
    assert (coulomb.value, coulomb.source) == (100.0, "scenario override")
    assert model.axes.ra.friction.stiction.value == LOW.axes.ra.friction.stiction.value
    assert made(overrides={}).axes == LOW.axes


@pytest.mark.parametrize(("overrides", "words"), [
    ({COULOMB: "x"}, f"plant: overrides: {COULOMB}: 'x' is no number"),
    ({COULOMB: 9e9}, "plant: "), ({"axes.ra.none": 1.0}, "plant: "), ({COULOMB: -1.0}, "plant: "),
])  # fmt: skip
def test_a_number_that_cannot_be_is_refused(overrides: dict[str, Any], words: str) -> None:
    with pytest.raises(ScenarioError) as caught:
        made(overrides=overrides)
    assert str(caught.value).startswith(words)


@pytest.mark.parametrize("axis", ["ra", "dec"])
def test_breaking_away_takes_no_less_than_sliding(axis: str) -> None:
    """As much is possible: there is no Stribeck effect then."""
    coulomb, stiction = (path.replace("ra", axis) for path in (COULOMB, STICTION))
    assert made(overrides={coulomb: 200.0, stiction: 200.0}).axes
    with pytest.raises(ScenarioError) as caught:
        made(overrides={coulomb: 200.0, stiction: 199.0})
    unit = getattr(LOW.axes, axis).friction.coulomb.unit
    assert str(caught.value) == (
        f"plant: overrides: {stiction} 199 {unit} is below coulomb, 200 {unit}"
    )
