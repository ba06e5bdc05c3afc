"""A mount's encoder against the sky, as a table: looked at as a guide log is."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import load_rig

RIG = """
rig: equatorial mount, encoder on the axis less the sky
columns:
  time: {column: t, unit: s}
  position: {column: error, unit: arcsec}
response: {channel: position, unit: arcsec}
stages:
  - {name: worm, period_s: 480}
  - {name: spur gear, of: worm, teeth: [47, 12]}
"""


def told(folder: Path, worm: float, gear: float, rate_hz: float = 1.0) -> Any:
    """The report on an hour of drift and noise with these amplitudes, arcsec."""
    rng = np.random.default_rng(4)
    t = np.arange(0.0, 4000.0, 1.0 / rate_hz)
    wander = np.cumsum(rng.normal(0, 0.02 / np.sqrt(rate_hz), len(t)))
    y = 3.0 + 0.004 * t + 1e-6 * t**2 + wander + rng.normal(0, 0.3, len(t))
    y = y + worm * np.cos(2 * np.pi * t / 480 + 0.4) + gear * np.cos(2 * np.pi * t * 47 / 12 / 480 - 1.0)
    np.savetxt(folder / "d.csv", np.column_stack([t, y]), "%.4f", ",", header="t,error", comments="")
    (folder / "rig.yaml").write_text(RIG)
    calibrate([folder / "d.csv"], folder / "rig.yaml", [], folder / "out", plots=False)
    return json.loads((folder / "out" / "report.json").read_text())


@pytest.mark.slow
def test_a_worm_and_a_gear_of_a_table_are_named(tmp_path: Path) -> None:
    report = told(tmp_path, 8.0, 3.0)
    found = {e["stage"]: e["parameters"]["amplitude"]["value"] for e in report["effects"]}
    assert {e["name"] for e in report["effects"]} == {"gear_eccentricity"}
    assert found == {"worm": pytest.approx(8.0, rel=0.1), "spur gear": pytest.approx(3.0, rel=0.1)}
    assert report["error"]["position"]["after"] < 0.25 * report["error"]["position"]["before"]
    assert report["error"]["position"]["unit"] == "arcsec"


def test_without_them_nothing_is(tmp_path: Path) -> None:
    assert told(tmp_path, 0.0, 0.0, 10.0)["effects"] == []


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("period_s: 480", "period: 480", "stages.worm: at constant rate the clock counts; give period_s"),
        ("response: {channel: position, unit: arcsec}", "estimate: [viscous]", "'response' is missing"),
        (
            "unit: arcsec}\nstages",
            "unit: arcsec, ratio: 2}\nstages",
            "response.ratio: is for a second sensor",
        ),
    ],
)
def test_a_mistake_gets_one_line(tmp_path: Path, old: str, new: str, says: str) -> None:
    path = tmp_path / "rig.yaml"
    path.write_text(RIG.replace(old, new, 1))
    with pytest.raises(CalibrationInputError, match=says):
        load_rig(path)
