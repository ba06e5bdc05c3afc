"""Stamps that shake beside samples taken on time, and samples that shake with stamps that say so."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from tests.calibration.logs import write_logs

RIG = """rig: arm
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  effort: {column: u, unit: N m}
response: {channel: effort, unit: N m}
estimate: [inertia, viscous, coulomb, offset]
"""
PERIOD_S = 0.004
PLACES = (333, 1040, 1500, 2222)  # rows at a steady rate


def log(folder: Path, stamps: str, shake_s: float, seed: int = 1) -> Path:
    """An arm that swings for 40 s: `stamps` "shake" beside even samples, "follow" samples that shake, or are
    "round" to a millisecond."""
    rng = np.random.default_rng(seed)
    even = PERIOD_S * np.arange(10_000) * (25 / 24 if stamps == "round" else 1.0)
    error = shake_s * rng.standard_normal(len(even))
    error[0] = 0.0
    taken = even + error if stamps == "follow" else even
    x = 1.2 * np.sin(2.1 * taken) + 0.8 * np.sin(5.3 * taken + 0.4)
    v = 1.2 * 2.1 * np.cos(2.1 * taken) + 0.8 * 5.3 * np.cos(5.3 * taken + 0.4)
    a = -1.2 * 2.1**2 * np.sin(2.1 * taken) - 0.8 * 5.3**2 * np.sin(5.3 * taken + 0.4)
    u = 0.05 * a + 0.1 * v + 0.3 * np.sign(v) + 0.002 * rng.standard_normal(len(even))
    t = np.round(even, 3) if stamps == "round" else even + error
    table = np.column_stack([t, np.round(x / 1e-5) * 1e-5, u])
    path = folder / "d.csv"
    np.savetxt(path, table, "%.7g" if stamps == "round" else "%.9f", ",", header="t,x,u", comments="")
    (folder / "rig.yaml").write_text(RIG)
    return path


def told(folder: Path, path: Path) -> Any:
    calibrate([path], folder / "rig.yaml", [], folder / "out", plots=False)
    return json.loads((folder / "out" / "report.json").read_text())


@pytest.mark.slow
@pytest.mark.parametrize("shake_s", [2e-4, 5e-4])
def test_stamps_that_shake_are_named_and_put_right(tmp_path: Path, shake_s: float) -> None:
    report = told(tmp_path, log(tmp_path, "shake", shake_s))
    (found,) = report["effects"]
    assert found["name"] == "clock_jitter"
    assert found["parameters"]["deviation"]["value"] == pytest.approx(shake_s, rel=0.05)
    (tmp_path / "sound").mkdir()
    sound = told(tmp_path / "sound", log(tmp_path / "sound", "shake", 0.0))
    assert sound["effects"] == []
    assert report["error"]["torque"]["after"] < 1.1 * sound["error"]["torque"]["after"]


@pytest.mark.slow
@pytest.mark.parametrize(("stamps", "shake_s"), [("follow", 5e-4), ("shake", 1e-5), ("round", 0.0)])
def test_right_stamps_are_left_alone(tmp_path: Path, stamps: str, shake_s: float) -> None:
    path = log(tmp_path, stamps, shake_s)
    (record,) = read_drive([path], load_rig_of(tmp_path)).runs
    assert [r.kind for r in record.repairs] == (["rounded"] if stamps == "round" else [])
    assert told(tmp_path, path)["effects"] == []


def load_rig_of(folder: Path) -> Any:
    return load_rig(folder / "rig.yaml")


@pytest.mark.slow
@pytest.mark.parametrize(("jumps", "name"), [(True, "unknown"), (False, "sample_loss")])
def test_a_stamp_that_jumps_is_no_lost_row_where_the_position_goes_on(
    tmp_path: Path, jumps: bool, name: str
) -> None:
    """At a steady rate 37 lost rows are 37 rows' travel, and a jump of the clock is one's."""
    paths = write_logs(tmp_path, [], ("steps", "steps", "steps"))
    for path in paths:
        lines = path.read_text().splitlines()
        first = next(k for k, line in enumerate(lines) if line.startswith("t,")) + 1
        rows = [line.split(",", 1) for line in lines[first:]]
        table, late_s = [], 0.0
        for k, (t, rest) in enumerate(rows):
            late_s += 0.37 * (k in PLACES)
            if jumps or not any(place <= k < place + 37 for place in PLACES):
                table.append(f"{float(t) + jumps * late_s:.6f},{rest}")
        path.write_text("\n".join(lines[:first] + table) + "\n")
    calibrate(paths, out=tmp_path / "out", plots=False, replay=False)
    (found,) = json.loads((tmp_path / "out" / "report.json").read_text())["effects"]
    assert (found["name"], found["domain"]) == (name, "clock")
    if jumps:
        assert found["parameters"]["jump"]["value"] == pytest.approx(0.37, abs=1e-6)
        assert found["note"].startswith("12 stamps")
