"""An axis as an FMU: valid by fmpy's checker, and the emulator's own numbers to the last bit."""

import zipfile
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from plant import fmu, model
from plant.effects import REGISTRY
from plant.fmu.library import FmuError
from plant.fmu.variables import exported
from plant.model import PlantModel
from plant.parts import EffectModel
from plant.plant import Plant
from scenarios.native import compiled
from tests.plant.fmu.recorded import Imported, differences, record

pytest.importorskip("fmpy", reason="python -m pip install fmpy")
from fmpy.validation import validate_fmu

LOOP = """name: loop
plant: low-preload
start_utc: 2026-02-10T14:00:00Z
steps:
  - power_on: {}
  - set_rate: {axis: ra, rate: 15 arcsec/s, for: %d s}
"""
PINS = ("incremental", "absolute", "auxiliary", "tachometer_a", "tachometer_b")
OF_LOG = ("sample_loss", "clock_jitter", "log_wrap")


def effects(names: list[str]) -> tuple[EffectModel, ...]:
    made = []
    for name in names:
        stages = REGISTRY[name].stages
        made.append(EffectModel(name, stages[0] if stages else None))
    return tuple(made)


CATALOGUE = [name for name in REGISTRY if name not in (*OF_LOG, "unknown")]


def export(tmp_path: Path, plant: PlantModel, fmi: int = 3, **start: float | bool) -> Imported:
    file = tmp_path / f"axis{fmi}.fmu"
    fmu.write(plant, "ra", 7, file, fmi)
    return Imported(file, tmp_path / f"{fmi}", fmi, **start)


def same(plant: PlantModel, imported: Imported, seconds: float = 2.0) -> None:
    """Both with the same duties, which change at any time within a grid step."""
    port = Plant(plant, 7).ra
    random = np.random.default_rng(3)
    t = 0
    while t < seconds * 1e9:
        duties = tuple(float(duty) for duty in random.uniform(0.0, 0.8, 2))
        port.drive(t, *duties)
        imported.drive(duties)
        t += int(random.integers(1, 9_000_000))
        imported.step(t)
        for name in PINS:
            assert imported.get(name) == getattr(port, name)(t), (name, t)
        for m, name in enumerate(("current_a", "current_b")):
            assert imported.get(name) == port.current(t, m), (name, t)
        assert (imported.get("angle"), imported.get("rate")) == port.truth(t)


@pytest.mark.parametrize("fmi", [2, 3])
def test_the_checker_finds_nothing_and_no_python_is_inside(tmp_path: Path, fmi: int) -> None:
    plant = model.with_effects(model.load("high_preload"), "ra", effects(CATALOGUE[:12]))
    file = tmp_path / "drive.fmu"
    fmu.write(plant, "ra", 1, file, fmi)
    assert validate_fmu(str(file)) == []
    with zipfile.ZipFile(file) as inside:
        library = next(name for name in inside.namelist() if name.endswith(".so"))
        assert b"Py_" not in inside.read(library)
        assert model.loads(inside.read("resources/plant.yaml").decode()) == plant
    again = tmp_path / "again.fmu"
    fmu.write(plant, "ra", 1, again, fmi)
    assert again.read_bytes() == file.read_bytes()


@pytest.mark.parametrize("fmi", [2, 3])
@pytest.mark.parametrize("name", ["low_preload", "high_preload_bridge"])
def test_the_plant_files_to_the_last_bit(tmp_path: Path, name: str, fmi: int) -> None:
    plant = model.load(name)
    same(plant, export(tmp_path, plant, fmi))


@pytest.mark.parametrize("part", range(3))
def test_every_effect_to_the_last_bit(tmp_path: Path, part: int) -> None:
    plant = model.with_effects(model.load(), "ra", effects(CATALOGUE[part::3]))
    same(plant, export(tmp_path, plant))


def test_parameters_and_switches_are_those_of_a_plant_file(tmp_path: Path) -> None:
    base = model.with_effects(model.load(), "ra", effects(["gear_mesh", "shaft_compliance", "channel_delay"]))
    changed = base
    start: dict[str, float | bool] = {"effects[1].shaft_compliance.enabled": False}
    for path, value in (
        ("axes.ra.friction.coulomb", 150.0),
        ("axes.ra.motor.inductance", 9.0),
        ("axes.ra.effects.0.amplitude", 3.0),
        ("axes.ra.effects.2.delay", 0.012),
        ("axes.ra.effects.2.column", 3.0),
    ):
        changed = model.with_value(changed, path, value)
        number = model.get(changed, path).si
        word = path.rpartition(".")[2]
        names = [each.name for each in exported(base, "ra", 7).parameters]
        start[next(name for name in names if name.endswith(f".{word}"))] = number
    on = tuple(e for e in changed.axes.ra.effects if e.name != "shaft_compliance")
    imported = export(tmp_path, base, **start)
    # the seed of a row holds its place among the effects; none of these is noise
    same(model.with_effects(changed, "ra", on), imported)
    unlike = Plant(base, 7).ra
    unlike.drive(0, 0.5, 0.0)
    assert unlike.incremental(imported.now) != imported.get("incremental")


@pytest.mark.parametrize("fmi", [2, 3])
def test_a_state_is_saved_and_restored(tmp_path: Path, fmi: int) -> None:
    imported = export(tmp_path, model.load(), fmi)
    imported.drive((0.4, 0.0))
    imported.step(1_000_000_000)
    end = "State" if fmi == 3 else "state"
    verbs = ("get", "set", "serialize", "deserialize" if fmi == 3 else "deSerialize", "free")
    get, set_, save, load, free = (getattr(imported.fmu, f"{verb}FMU{end}") for verb in verbs)
    state = get()
    kept = save(state)
    ends: list[Any] = []
    for again in (state, load(kept)):
        set_(again)
        imported.now = 1_000_000_000
        imported.step(2_000_000_000)
        ends.append([imported.get(name) for name in (*PINS, "angle", "torque", "friction")])
    assert ends[0] == ends[1]
    assert ends[0][0] > 0
    free(state)


def test_a_device_is_no_archive() -> None:
    with pytest.raises(FmuError, match="/dev/null: is no regular file"):
        fmu.write(model.load(), "ra", 1, Path("/dev/null"), 3)


def test_what_it_refuses(tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    imported = export(tmp_path, model.load())
    for name, value in (("duty_a", 1.5), ("friction.coulomb", -1.0)):
        full = next(each for each in imported.refs if each.endswith(name))
        with pytest.raises(Exception, match="Float64"):
            imported.set(full, value)
    with pytest.raises(Exception, match=r"[Bb]oolean"):
        imported.fmu.setBoolean([40], [True])
    with pytest.raises(Exception, match="DoStep"):
        imported.fmu.doStep(3.0, 0.1)


def replayed(tmp_path: Path, seconds: int, patch: pytest.MonkeyPatch) -> None:
    """A velocity loop on the boards, and the FMU with its duties."""
    scenario = tmp_path / "loop.yaml"
    scenario.write_text(LOOP % seconds)
    run = record(scenario, tmp_path / "out", patch)
    file = tmp_path / "drive.fmu"
    fmu.write(run.model, "ra", run.seed, file)
    unlike = differences(run.events, Imported(file, tmp_path / "in", start_angle=run.start_angle))
    assert {(event.t, event.pin) for event, _ in unlike} <= run.ahead
    assert {event.pin for event, _ in unlike} <= {"current_a", "current_b"}
    worst = max((abs(event.value - said) for event, said in unlike), default=0.0)
    print(f"{len(run.events)} values, {len(unlike)} currents a grid step older, by at most {worst:.4f} A")
    assert worst < 0.0061  # A, one count of the boards' converter (boards/silicon/adc.py)
    assert len(unlike) < 0.02 * len(run.events)


@pytest.mark.skipif(compiled(), reason="the pins are recorded by patching the plain source")
def test_the_closed_loop_to_the_last_bit(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    replayed(tmp_path, 20, monkeypatch)


@pytest.mark.skipif(compiled(), reason="the pins are recorded by patching the plain source")
@pytest.mark.slow
def test_ten_minutes_of_the_closed_loop(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    replayed(tmp_path, 600, monkeypatch)
