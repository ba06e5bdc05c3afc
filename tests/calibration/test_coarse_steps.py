"""A sensor whose steps are as coarse as a bristle's travel raises the floor at reversals only."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from tests.blind.drives.case import Order, seal


def answer(folder: Path, names: tuple[str, ...], ratio: float, seed: int = 1024) -> dict[str, Any]:
    """The report on a geared servo of 4096 steps a turn; its floor is mostly friction within a step."""
    cell = "single" if names else "nothing"
    order = Order("servo", cell, "servo", names, ratio, "gaussian", "", 40.0)
    seal(order, seed, folder / "logs", folder / "truth")
    logs = sorted((folder / "logs" / "servo").glob("*.csv"))
    rig = folder / "logs" / "servo" / "rig.yaml"
    assert calibrate(logs, rig, [], folder / "out", plots=False) == 0
    report: dict[str, Any] = json.loads((folder / "out" / "report.json").read_text(encoding="utf-8"))
    return report


@pytest.mark.slow
@pytest.mark.parametrize("ratio", [2.0, 4.0])
def test_friction_over_the_travel_is_named_and_leaves_the_floor(tmp_path: Path, ratio: float) -> None:
    report = answer(tmp_path, ("position_friction",), ratio)
    assert report["effects"][0]["name"] == "position_friction"
    hidden = json.loads((tmp_path / "truth" / "servo.json").read_text())["effects"][0]["raw"]["POSF"]
    size = report["effects"][0]["parameters"]["amplitude"]
    assert size["value"] == pytest.approx(hidden, rel=0.25)
    assert report["error"]["torque"]["after"] < report["error"]["torque"]["floor"]


@pytest.mark.slow
def test_what_the_steps_leave_has_no_name(tmp_path: Path) -> None:
    assert answer(tmp_path, (), 0.0)["effects"] == []


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1038, 1039, 1042])
def test_a_fault_that_comes_and_goes_at_one_place_is_unknown_there(tmp_path: Path, seed: int) -> None:
    """A brush that sticks in a sector, half of the time: most of it is below the floor of all rows."""
    report = answer(tmp_path, ("sticking_brush",), 5.0, seed)
    assert {(e["name"], e["domain"]) for e in report["effects"]} == {("unknown", "axis_angle")}


STEP = 1.5e-3  # rad, of both sensors
SENSORS = """rig: joint
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  position2: {column: y, unit: rad}
response: {channel: position2, unit: rad}
estimate: [offset]
smooth_s: 0.1
"""


def test_steps_that_a_slow_motion_stays_on_are_in_the_floor(tmp_path: Path) -> None:
    """Two encoders of one shaft that turns a step in 3 s, every other five seconds up to 400 times as
    quick: the filter of 0.1 s averages few of the slow ones."""
    t = np.arange(0.0, 60.0, 0.005)
    rng = np.random.default_rng(8)
    rate = 5e-4 + 0.2 * np.maximum(np.sin(2 * np.pi * t / 10.0), 0.0)
    true = np.cumsum(rate) * 0.005
    files = []
    for k in range(2):
        x, y = (np.floor(true / STEP + rng.random()) * STEP for _ in range(2))
        files.append(tmp_path / f"{k}.csv")
        np.savetxt(files[-1], np.column_stack([t, x, y]), delimiter=",", header="t,x,y", comments="")
    rig = tmp_path / "rig.yaml"
    rig.write_text(SENSORS)
    calibrate(files, rig, [], tmp_path / "out", plots=False)
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    row = report["error"]["position"]
    assert report["effects"] == []
    assert 0.5 < row["after"] / row["floor"] < 1.4  # the zeros' distance d decides: sqrt(6 d (1 - d))
    averaged = STEP / np.sqrt(6.0) * np.sqrt(0.005 / (2 * np.sqrt(np.pi) * 0.1))  # were the steps noise
    assert row["floor"] > 2 * averaged


@pytest.mark.slow
def test_nothing_is_judged_before_a_gap_has_been_crossed(tmp_path: Path) -> None:
    """A belt drive that begins every file somewhere in its gap; 7.9 floors were left by the first second."""
    order = Order("drive-single-play-belt-2-0", "single", "belt", ("play",), 2.0, seconds=40.0)
    seal(order, 1062, tmp_path / "logs", tmp_path / "truth")
    folder = tmp_path / "logs" / order.key
    calibrate(sorted(folder.glob("*.csv")), folder / "rig.yaml", [], tmp_path / "out", plots=False)
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    assert [e["name"] for e in report["effects"]] == ["play"]
    assert report["error"]["position"]["after"] < 2 * report["error"]["position"]["floor"]


@pytest.mark.slow
def test_a_line_beside_a_motors_harmonic_is_not_the_motors(tmp_path: Path) -> None:
    """Order 5.67 on a table whose travel is hardly a turn: sixty harmonics together follow it, too."""
    key = "drive-single-bearing_pass-table-5-0"
    order = Order(key, "single", "table", ("bearing_pass",), 5.0, seconds=40.0)
    seal(order, 1062, tmp_path / "logs", tmp_path / "truth")
    folder = tmp_path / "logs" / order.key
    calibrate(sorted(folder.glob("*.csv")), folder / "rig.yaml", [], tmp_path / "out", plots=False)
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    (found,) = report["effects"]
    hidden = json.loads((tmp_path / "truth" / f"{order.key}.json").read_text())["effects"][0]["raw"]
    assert found["name"] == "bearing_pass"
    assert found["order"] == pytest.approx(hidden["LINE_K"], abs=0.05)
