"""Facts that a plant file needs beside the findings, and what is written and run when."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.inputs.train import MESH, SHAFT
from calibration.look.looked import Looked, Options
from calibration.names.inplant import Facts
from calibration.replay import corrected as module
from calibration.replay.corrected import (
    correct_and_replay,
    facts_of,
    twists,
)
from calibration.replay.held import Replay
from plant.gears import RATIO
from plant.model import load, with_effects
from tests.calibration.report.drawn import effect, problem, selection

MODEL = with_effects(load("low_preload"), "ra", [])


def result_of(**more: Any) -> Any:
    run = SimpleNamespace(name="run1", header={"axis": "ra"})
    motion = SimpleNamespace(x=np.array([1.0, 2.0, 4.0, 99.0]), rows=np.array([0, 1, 2]))
    frame = SimpleNamespace(runs=[run], t=np.array([5.0, 6.0, 9.0, 99.0]), scale={"supply_V": 36.0})
    plain: dict[str, Any] = {"frame": frame, "motion": motion, "torque": None, "selections": {},
             "held": "held", "declared": SimpleNamespace(ripple=None, lines=())}  # fmt: skip
    return SimpleNamespace(**(plain | more))


def test_the_facts_of_a_log_stand_beside_the_findings() -> None:
    part = MODEL.axes.ra
    loop = part.motor.loop
    torque = SimpleNamespace(drive=SimpleNamespace(per_ampere=77.0))
    found = facts_of(result_of(torque=torque), {"resistance": Parameter(loop + 0.5, "ohm")}, MODEL, "a log")
    assert (found.name, found.axis, found.span) == ("a log", "ra", 3.0)
    assert found.middle == pytest.approx(7 / 3)
    assert (found.duration_s, found.supply, found.per_ampere) == (4.0, 36.0, 77.0)
    assert found.half_play == pytest.approx(0.5 * part.gear.backlash.si * RATIO)
    assert found.resistance == loop + 0.5 and found.winding == pytest.approx(0.5 + part.motor.resistance.si)
    assert found.warming == MODEL.environment.warming.si and found.twists == {}
    plain = facts_of(result_of(), {}, MODEL, "a log")
    assert (plain.resistance, plain.per_ampere) == (loop, 140.0)
    assert facts_of(result_of(), {"resistance": Parameter(0.0, "ohm")}, MODEL, "a log").winding == 0.1
    still = result_of()
    still.frame.t = np.zeros(4)
    assert facts_of(still, {}, MODEL, "a log").duration_s == 1.0


def test_a_twist_is_a_gears_line_that_both_trains_show(monkeypatch: pytest.MonkeyPatch) -> None:
    sizes = {"amplitude": Parameter(3.0, "arcsec"), "phase": Parameter(0.5, "rad")}
    monkeypatch.setattr(module, "parameters_of", lambda s, k: sizes if k in (0, 4) else {})
    both, one = np.ones(8), np.where(np.arange(8) < 4, 1.0, 0.0)
    candidates = [
        effect(both, MESH, stage="mesh2", harmonic=2),
        effect(one, MESH, stage="a"), effect(1 - one, SHAFT, stage="b"),
        effect(both, "drag", stage="c"), effect(both, SHAFT, stage="d"), effect(both, SHAFT),
    ]  # fmt: skip
    s = selection(problem(np.zeros(8)), *candidates)
    assert twists(result_of(selections={"K": s})) == {("mesh2", 2): (3.0, 0.5), ("d", 1): (3.0, 0.5)}


def looked(**more: Any) -> Looked:
    header = {"axis": "ra", "preload": "low", "note": ""}
    return Looked(**({"title": "", "header": header, "axis": result_of()} | more))


def written(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path, found: Looked, run: bool = True
) -> tuple[Replay, dict[str, Any]]:
    got: dict[str, Any] = {"told": []}

    def replayed(*given: Any) -> Replay:
        got["replay"] = given
        return Replay(reasons=["replayed"])

    def plant(out: Path, model: Any, calibrated: Any, effects: Any, facts: Facts, skip: Any) -> Any:
        got["plant"] = (out, calibrated, effects, facts, skip)
        out.write_text("")
        return "corrected", ["a remark"]

    monkeypatch.setattr(module, "replay", replayed)
    monkeypatch.setattr(module, "write_plant", plant)
    monkeypatch.setattr(module, "load", lambda path: MODEL)
    monkeypatch.setattr(module, "declared_model", lambda header, path: (MODEL, False))
    monkeypatch.setattr(module, "calibrate_model", lambda *given: (given, []))
    monkeypatch.setattr("plant.compensation.write", lambda out, *_: got.update(compensation=out))
    options = Options(out=tmp_path, replay=run, tell=got["told"].append)
    return correct_and_replay(found, options), got


def test_a_drive_that_the_emulator_does_not_run_has_no_plant(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    again, got = written(monkeypatch, tmp_path, Looked(title=""))
    assert again.reasons == () and set(got) == {"told"}
    again, got = written(monkeypatch, tmp_path, looked(axis=None))
    assert got["plant"] == (tmp_path / "plant.yaml", {}, [], Facts("cannot tell", "ra"), [])
    assert again.reasons == () and "replay" not in got and "compensation" not in got


def test_the_corrected_plant_is_written_and_run_again(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    found = looked(effects=[Finding("drag", "T", "time")], not_identifiable=["viscous"])
    again, got = written(monkeypatch, tmp_path, found)
    _, calibrated, effects, facts, skip = got["plant"]
    assert (calibrated, effects, skip, facts.name) == ({}, found.effects, ["viscous"], "run1")
    assert got["compensation"] == tmp_path / "compensation.yaml" and got["told"] == [
        "running the closed loop again"
    ]
    assert again.reasons == ["replayed", "a remark"]
    _, held, declared, corrected, per_ampere, mean = got["replay"]
    assert (held, corrected, per_ampere, mean) == ("held", "corrected", 0.0, False) and declared[3:] == (
        "run1",
        ["viscous"],
    )
    silent, got = written(monkeypatch, tmp_path, found, run=False)
    assert silent.reasons == ["a remark"] and "replay" not in got and got["told"] == []


def test_mean_currents_are_those_of_a_declared_or_a_fitted_ripple(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    torque = SimpleNamespace(drive=SimpleNamespace(per_ampere=77.0))
    e = SimpleNamespace(
        chosen=[], problem=SimpleNamespace(base_labels=[("resistance", "ohm"), ("current_ripple", "A")])
    )
    declared = SimpleNamespace(ripple=0.1, lines=())
    for more, mean in (({"declared": declared}, True), ({"selections": {"E": e}}, True), ({}, False)):
        given = result_of(torque=torque, **more)
        got = written(monkeypatch, tmp_path, looked(axis=given))[1]["replay"]
        assert got[4:] == (77.0, mean)
