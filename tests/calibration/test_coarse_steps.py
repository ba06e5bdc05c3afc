"""A sensor whose steps are as coarse as a bristle's travel raises the floor at reversals only."""

import json
from pathlib import Path
from typing import Any

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


@pytest.mark.parametrize("ratio", [2.0, 4.0])
def test_friction_over_the_travel_is_named_although_the_floor_is_as_high(
    tmp_path: Path, ratio: float
) -> None:
    report = answer(tmp_path, ("position_friction",), ratio)
    assert report["effects"][0]["name"] == "position_friction"
    hidden = json.loads((tmp_path / "truth" / "servo.json").read_text())["effects"][0]["raw"]["POSF"]
    size = report["effects"][0]["parameters"]["amplitude"]
    assert size["value"] == pytest.approx(hidden, rel=0.25)
    assert report["error"]["torque"]["before"] < 2 * report["error"]["torque"]["floor"]


def test_what_the_steps_leave_has_no_name(tmp_path: Path) -> None:
    assert answer(tmp_path, (), 0.0)["effects"] == []


@pytest.mark.parametrize("seed", [1038, 1039, 1042])
def test_a_fault_that_comes_and_goes_at_one_place_is_unknown_there(tmp_path: Path, seed: int) -> None:
    """A brush that sticks in a sector, half of the time: most of it is below the floor of all rows."""
    report = answer(tmp_path, ("sticking_brush",), 5.0, seed)
    assert {(e["name"], e["domain"]) for e in report["effects"]} == {("unknown", "axis_angle")}
