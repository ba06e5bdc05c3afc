"""Stamps that shake beside samples taken on time, and samples that shake with stamps that say so."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table

RIG = """rig: arm
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  effort: {column: u, unit: N m}
response: {channel: effort, unit: N m}
estimate: [inertia, viscous, coulomb, offset]
"""
PERIOD_S = 0.004


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


@pytest.mark.parametrize("shake_s", [2e-4, 5e-4])
def test_stamps_that_shake_are_named_and_put_right(tmp_path: Path, shake_s: float) -> None:
    report = told(tmp_path, log(tmp_path, "shake", shake_s))
    (found,) = report["effects"]
    assert found["name"] == "clock_jitter"
    assert found["parameters"]["sigma"]["value"] == pytest.approx(shake_s, rel=0.05)
    (tmp_path / "sound").mkdir()
    sound = told(tmp_path / "sound", log(tmp_path / "sound", "shake", 0.0))
    assert sound["effects"] == []
    assert report["error"]["torque"]["after"] < 1.1 * sound["error"]["torque"]["after"]


@pytest.mark.parametrize(("stamps", "shake_s"), [("follow", 5e-4), ("shake", 1e-5), ("round", 0.0)])
def test_right_stamps_are_left_alone(tmp_path: Path, stamps: str, shake_s: float) -> None:
    path = log(tmp_path, stamps, shake_s)
    (record,) = read_table(path, load_rig_of(tmp_path))
    assert [r.kind for r in record.repairs] == (["rounded"] if stamps == "round" else [])
    assert told(tmp_path, path)["effects"] == []


def load_rig_of(folder: Path) -> Any:
    return load_rig(folder / "rig.yaml")
