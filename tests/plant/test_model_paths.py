"""Plant files by name and by path, what is written of them, and numbers by their paths."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest
import yaml

from plant import model
from plant.model import ModelError
from plant.parts import EffectModel, Function, MountErrors, Number, PlantModel
from tests.plant.bench import bare

FORMAT = "format: schmidt-plant 1\n"


def effects(*made: EffectModel) -> PlantModel:
    return model.with_effects(bare(), "ra", made)


def written(made: EffectModel) -> dict[str, Any]:
    (found,) = yaml.safe_load(model.dumps(effects(made)))["axes"]["ra"]["effects"]
    assert isinstance(found, dict)
    return found


def error(text: str) -> str:
    with pytest.raises(ModelError) as caught:
        model.loads(text, "a.yaml")
    return str(caught.value)


def test_a_bare_name_is_one_of_the_project_s_unless_such_a_file_is_there(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert model.load("high_preload").name == "high_preload"
    assert model.load().name == model.DEFAULT == "low_preload_bridge"
    (tmp_path / "high_preload").write_text(model.dumps(replace(bare(), name="mine")))
    assert model.load("high_preload").name == "mine"
    model.dump(replace(bare(), name="other"), tmp_path / "b.yaml")
    assert model.load(tmp_path / "b.yaml").name == model.load("b.yaml").name == "other"


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("high_prelod", "high_prelod: no such plant file; did you mean 'high_preload'?"),
        ("none.yaml", "none.yaml: no such plant file"),
        ("folder.d", "folder.d: cannot be read: it is no regular file"),
        ("xyz", "xyz: no such plant file; use one of high_preload, "),
    ],
)
def test_a_file_that_cannot_be_read_is_said(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, words: str
) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.d").mkdir()
    with pytest.raises(ModelError) as caught:
        model.load(name)
    assert str(caught.value).startswith(words)
    assert ("use one of" in words) or str(caught.value) == words


def test_a_text_that_is_no_plant_file_is_said_with_its_line() -> None:
    assert error("") == "a.yaml: is empty"
    assert error("# nothing\n") == "a.yaml: is empty"
    assert error("- 1") == "a.yaml, line 1: file: expected a mapping of fields"
    for text in ("name: x", "format: other"):
        assert error(text) == "a.yaml, line 1: format: expected 'format: schmidt-plant 1'"
    assert error(FORMAT + "name: *x") == "a.yaml, line 2: not YAML: found undefined alias"
    assert error(FORMAT + "a: 1\na: 2").startswith("a.yaml, line 3: 'a' is given twice")
    assert error(FORMAT + "a: [").startswith("a.yaml, line 2: is not YAML") or "line 3" in error(
        FORMAT + "a: ["
    )
    assert error(FORMAT + "nam: x") == "a.yaml, line 2: nam: unknown field; did you mean 'name'?"


def test_an_effect_is_written_with_what_it_has_alone() -> None:
    assert written(EffectModel("wind_torque")) == {"name": "wind_torque"}
    mesh = EffectModel("gear_mesh", "mesh2", 3, {"phase": Number(0.5, "rad", "why")}, enabled=False)
    assert written(mesh) == {
        "name": "gear_mesh", "stage": "mesh2", "harmonic": 3, "enabled": False,
        "parameters": {"phase": {"value": 0.5, "unit": "rad", "source": "why"}},
    }  # fmt: skip
    function = Function("command", "time", "linear", 0.0, ((0.0, 1.0), (2.0, 3.0)), "why", 2)
    found = written(EffectModel("unknown", function=function))["function"]
    assert found["motor"] == 2 and found["knots"] == [[0.0, 1.0], [2.0, 3.0]] and found["period"] == 0.0
    assert "motor" not in written(EffectModel("unknown", function=replace(function, motor=0)))["function"]


def test_a_file_keeps_its_order_its_letters_and_short_lines() -> None:
    named = replace(bare(), description="±1 °C: " + "a " * 200)
    text = model.dumps(named)
    assert list(yaml.safe_load(text))[:4] == ["format", "name", "description", "numerics"]
    assert "±1 °C" in text and "mount" not in text and "stops" not in text and "diode_drop" not in text
    described = text[text.index("description") : text.index("numerics")].splitlines()
    assert [len(line) for line in described[1:3]] == [111, 111]  # a word that begins up to column 110
    assert model.loads(text) == named


def test_numbers_have_paths() -> None:
    mesh = EffectModel("gear_mesh", "mesh1", parameters={"amplitude": Number(3.0, "N m", "why")})
    given = effects(EffectModel("wind_torque"), mesh)
    found = model.numbers(given)
    assert found["axes.ra.effects.1.amplitude"].value == 3.0
    assert found["numerics.grid"] is given.numerics.grid
    assert not any(path.startswith((".", "name", "mount")) for path in found)
    with pytest.raises(ModelError, match=r"no number at 'focus\.travl'; did you mean 'focus\.travel'"):
        model.get(given, "focus.travl")


def test_a_number_changes_its_value_and_its_source_when_there_is_one() -> None:
    base = bare()
    before = model.get(base, "numerics.grid")
    kept = model.get(model.with_value(base, "numerics.grid", 250), "numerics.grid")
    assert kept == Number(250.0, "us", before.source) and isinstance(kept.value, float)
    told = model.get(model.with_value(base, "numerics.grid", 250, ""), "numerics.grid")
    assert told.source == ""


def test_a_parameter_of_the_second_effect_changes_there_alone() -> None:
    mesh = EffectModel("gear_mesh", "mesh1", parameters={"phase": Number(90.0, "deg", "why")})
    made = model.with_value(effects(mesh, mesh, EffectModel("wind_torque")), "axes.ra.effects.1.phase", 45.0)
    first, second, third = made.axes.ra.effects
    assert first == mesh and third == EffectModel("wind_torque")
    assert second.parameters == {"phase": Number(45.0, "deg", "why")}
    default = model.with_value(made, "axes.ra.effects.2.mean", 7.0, "mine").axes.ra.effects[2]
    assert default.parameters == {"mean": Number(7.0, "N m", "mine")}
    assert made.axes.dec == bare().axes.dec


@pytest.mark.parametrize(
    "path",
    ["", "axes", "axes.ra", "axes.ra.effects", "axes.ra.effects.7.mean", "axes.ra.effects.0", "name",
     "numerics.grid.value", "numerics.grid.grid", "mount.refraction", "axes.ra.effects.0.men"],
)  # fmt: skip
def test_a_path_that_leads_to_no_number_is_said(path: str) -> None:
    with pytest.raises(ModelError, match=f"^plant model: no number at '{path}'$"):
        model.with_value(effects(EffectModel("wind_torque")), path, 1.0)


def test_a_mount_has_typical_errors_its_own_or_none() -> None:
    typical = model.with_mount_errors(bare())
    assert typical.mount == MountErrors()
    own = replace(bare(), mount=MountErrors(refraction=Number(3.0, "arcsec", "why")))
    assert model.with_mount_errors(own) == own
    assert model.with_mount_errors(own, False).mount is None
    assert model.loads(model.dumps(own)) == own
