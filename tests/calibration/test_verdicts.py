"""Whole calls on logs of the plant's own loop: nothing, found with its place, and an effect outside the
catalogue."""

import json
from pathlib import Path
from typing import Any

import pytest

from calibration.command import calibrate
from plant.model import default_files, load
from plant.parts import EffectModel
from tests.calibration.logs import effect, write_logs

pytestmark = pytest.mark.long


def answer(folder: Path, effects: list[EffectModel]) -> dict[str, Any]:
    out = folder / "out"
    # the plant file says that Table 1 is both trains' stiffness: without it half a train's is "cannot tell"
    declared = default_files()["low_preload"]
    assert calibrate(write_logs(folder, effects), None, [], out, declared, plots=False) == 0
    report: dict[str, Any] = json.loads((out / "report.json").read_text())
    load(out / "plant.yaml")  # a plant that the emulator runs
    for row in report["error"].values():
        assert row["after"] <= row["before"] * 1.002  # nothing accepted makes held-out data worse
    assert not any(c["accepted"] for c in report["controls"])
    return report


def test_a_log_without_an_effect_is_answered_nothing_and_recalibrates_the_declared_model(
    tmp_path: Path,
) -> None:
    report = answer(tmp_path, [])
    assert report["verdict"] == "nothing" and report["effects"] == []
    model = load(default_files()["low_preload"])
    friction = model.axes.ra.friction
    for name, true in (
        ("coulomb", friction.coulomb.si),
        ("viscous", friction.viscous.si),
        ("torque_constant", model.axes.ra.motor.torque_constant.si),
    ):
        assert report["calibrated"][name]["value"] == pytest.approx(true, rel=0.03)
    assert report["error"]["torque"]["before"] < 3 * report["error"]["torque"]["floor"]


def test_a_mesh_is_found_with_its_stage_amplitude_and_a_held_out_gain(tmp_path: Path) -> None:
    report = answer(tmp_path, [effect("gear_mesh", "mesh3", amplitude=(6.0, "N m"))])
    assert report["verdict"] == "found"
    top = report["effects"][0]
    assert (top["name"], top["stage"], top["harmonic"], top["channel"]) == ("gear_mesh", "mesh3", 1, "T")
    assert top["parameters"]["amplitude"]["value"] == pytest.approx(6.0, rel=0.05)
    assert report["error"]["torque"]["after"] < 0.3 * report["error"]["torque"]["before"]
    effects = load(tmp_path / "out" / "plant.yaml").axes.ra.effects
    declared = load(default_files()["low_preload"]).axes.ra.effects
    assert [e.name for e in effects] == [*(e.name for e in declared), "gear_mesh"]


def test_two_effects_in_different_channels_are_both_named(tmp_path: Path) -> None:
    report = answer(
        tmp_path,
        [
            effect("gear_eccentricity", "shaft1", amplitude=(6.0, "N m")),
            effect("pwm_deadband", deadband=(0.01, "1")),
        ],
    )
    assert {e["name"] for e in report["effects"]} == {"gear_eccentricity", "pwm_deadband"}


def test_a_drag_that_begins_in_every_run_is_a_brake_and_nothing_else(tmp_path: Path) -> None:
    """The plant's clock starts anew with every run of these logs: 40 N m from 20 s on, in each."""
    drag = effect("brake_drag", torque=(40.0, "N m"), start=(20.0, "s"), duration=(1e6, "s"))
    report = answer(tmp_path, [drag])
    assert [e["name"] for e in report["effects"]] == ["brake_drag"]
    found = report["effects"][0]["parameters"]
    assert found["torque"]["value"] == pytest.approx(40.0, rel=0.05)
    assert found["start_in_run"]["value"] == pytest.approx(20.0, abs=0.1)
    assert report["error"]["torque"]["after"] < 0.2 * report["error"]["torque"]["before"]


def test_play_of_the_encoder_is_named_and_taken_out_of_the_positions(tmp_path: Path) -> None:
    report = answer(tmp_path, [effect("play", gap=(6.0, "arcsec"), encoder=(1.0, "1"))])
    assert [e["name"] for e in report["effects"]] == ["play"]
    # one torque either way: the step of the gap and the line of the wind-up come apart to a tenth only
    gap = report["effects"][0]["parameters"]["gap"]
    assert gap["low"] < 6.0 < gap["high"] < 9.0
    assert report["error"]["position"]["after"] < 0.5 * report["error"]["position"]["before"]


def test_a_square_between_effort_and_amplifier_is_a_disturbance_with_its_frequency(tmp_path: Path) -> None:
    square = effect("command_disturbance", amplitude=(0.03, "1"), frequency=(0.8, "Hz"), shape=(1.0, "1"))
    report = answer(tmp_path, [square])
    assert [e["name"] for e in report["effects"]] == ["command_disturbance"]
    found = report["effects"][0]["parameters"]
    assert found["frequency"]["value"] == pytest.approx(0.8, abs=0.001)
    assert found["amplitude"]["value"] == pytest.approx(0.03, rel=0.1)
