"""Plant files: every number has unit and source, errors name the place, what is written reads back the
same.
"""

import dataclasses

import pytest

from plant import model
from plant.gears import RATIO
from plant.model import ModelError

FILES = sorted(model.default_files())


def test_four_plant_files_both_preloads_and_both_readings() -> None:
    kinds = ("", "_bridge", "_motor_units")
    assert [f"{preload}_preload{kind}" for preload in ("high", "low") for kind in kinds] == FILES


@pytest.mark.parametrize("name", FILES)
def test_written_model_reads_back_the_same(name: str) -> None:
    loaded = model.load(name)
    assert model.loads(model.dumps(loaded)) == loaded


@pytest.mark.parametrize("name", FILES)
def test_every_number_has_a_source(name: str) -> None:
    for path, number in model.numbers(model.load(name)).items():
        assert number.source.strip(), path


def test_P5_table_2_of_the_paper_is_what_the_files_declare() -> None:
    low, high = (model.load(f"{name}_preload").axes.ra.friction for name in ("low", "high"))
    assert [low.viscous.si, low.coulomb.si, low.stiction.si, low.stribeck_rate.si] == [6700, 229, 621, 4e-4]
    assert [high.viscous.si, high.coulomb.si, high.stiction.si, high.stribeck_rate.si] == [
        11300,
        217,
        1490,
        7e-4,
    ]


def test_P5_motor_reading_is_N_mm_at_the_motor_shaft() -> None:
    friction = model.load("low_preload_motor_units").axes.ra.friction
    assert friction.coulomb.si == pytest.approx(0.229 * RATIO)
    assert friction.viscous.si == 6700


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("    friction:", "    frictoin:", ["axes.ra.frictoin", "did you mean 'friction'"]),
        ("value: 229", "value: many", ["axes.ra.friction.coulomb.value", "expected a number", "many"]),
        ("value: 229", "value: -1", ["axes.ra.friction.coulomb", "outside"]),
        ("unit: kg m2", "unit: kgm2", ["axes.ra.inertia.unit", "did you mean 'kg m2'"]),
        ("name: gear_eccentricity", "name: gear_excentricity", ["did you mean 'gear_eccentricity'"]),
        ("stage: motor", "stage: moter", ["axes.ra.effects.0.stage", "did you mean 'motor'"]),
        ("harmonic: 2", "harmonic: 0", ["axes.ra.effects.0.harmonic", "1 to 1000"]),
        ("format: schmidt-plant 1", "format: something", ["format: schmidt-plant 1"]),
    ],
)
def test_a_wrong_file_names_line_field_and_nearest_word(old: str, new: str, words: list[str]) -> None:
    text = model.default_files()["low_preload"].read_text()
    assert old in text
    changed = text.replace(old, new, 1)
    expected = text[: text.index(old)].count("\n") + 1
    with pytest.raises(ModelError) as error:
        model.loads(changed, "my.yaml")
    message = str(error.value)
    assert message.startswith("my.yaml, line ")
    assert abs(int(message.split("line ")[1].split(":")[0]) - expected) <= 1
    for word in words:
        assert word in message


def test_missing_field_and_not_yaml_are_errors_with_a_line() -> None:
    text = model.default_files()["low_preload"].read_text()
    without = "\n".join(line for line in text.split("\n") if not line.startswith("    inertia:"))
    with pytest.raises(ModelError, match=r"axes\.ra\.inertia: missing"):
        model.loads(without)
    with pytest.raises(ModelError, match=r"line \d+: (is )?not YAML"):
        model.loads(text + "\n  : [", "x")


def test_unknown_plant_name_gets_the_nearest(tmp_path: object) -> None:
    with pytest.raises(ModelError, match="did you mean 'low_preload'"):
        model.load("low_prelod")


def test_with_value_changes_one_number_only() -> None:
    base = model.load()
    changed = model.with_value(base, "axes.ra.friction.coulomb", 250.0, "my log")
    assert model.get(changed, "axes.ra.friction.coulomb").value == 250.0
    differing = [p for p, n in model.numbers(base).items() if model.numbers(changed)[p] != n]
    assert differing == ["axes.ra.friction.coulomb"]


def test_with_value_reaches_effect_parameters_even_at_their_default() -> None:
    changed = model.with_value(model.load(), "axes.ra.effects.0.phase", 1.5)
    assert model.get(changed, "axes.ra.effects.0.phase").value == 1.5
    with pytest.raises(ModelError, match="no number at"):
        model.with_value(changed, "axes.ra.effects.0.colour", 1.0)


def test_models_are_frozen() -> None:
    with pytest.raises(dataclasses.FrozenInstanceError):
        model.load().name = "other"  # type: ignore[misc]
