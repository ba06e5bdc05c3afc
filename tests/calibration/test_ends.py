"""Currents that stop at the end of their converter are left out, whoever says where it is."""

import json
from pathlib import Path

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.inputs.run import Run
from calibration.inputs.stuck import converter_end, piled_at
from tests.blind.drives.case import seal
from tests.blind.drives.cells import SETS

ROWS = 4000


def currents(noise: float) -> tuple[np.ndarray, np.ndarray]:
    """Effort of a slow sine, of full range 2, and a current of 400 counts per unit with `noise` counts."""
    effort = np.sin(np.linspace(0, 60, ROWS))
    rng = np.random.default_rng(1)
    return effort, np.round(np.maximum(400 * effort, 0) + noise * rng.standard_normal(ROWS))


@pytest.mark.parametrize("noise", [0.0, 0.3, 2.0])
def test_a_sound_current_has_no_end(noise: float) -> None:
    effort, x = currents(noise)
    assert piled_at(x, effort, x.max(), x.max() - 1) is None


@pytest.mark.parametrize("end", [100.0, 300.0])
def test_a_clipped_one_has(end: float) -> None:
    effort, x = currents(2.0)
    found = piled_at(np.minimum(x, end), effort, end, end - 1)
    assert found is not None
    assert found[0] == np.sum(x >= end)


@pytest.mark.parametrize("x", [np.full(ROWS, np.nan), np.zeros(ROWS), np.full(ROWS, 3.0)])
def test_a_current_that_never_changes_has_no_end(x: np.ndarray) -> None:
    run = Run("r", Path("r.csv"), "s", {"current_a": x, "effort": currents(0.0)[0]}, {}, {}, {})
    assert converter_end([run], ("current_a", "current_b")) is None


def test_a_steady_effort_makes_a_steady_current() -> None:
    effort = np.repeat([0.0, 0.5, 0.2], ROWS)
    assert piled_at(400 * effort, effort, 200.0, 199.0) is None


@pytest.mark.slow
def test_an_axis_with_clipped_currents_is_understood(tmp_path: Path) -> None:
    """Thousands of rows at 8.19 A, the end of twelve bits at 2 mA: with them the motors' constant came out
    negative and the drag had two unnamed neighbours."""
    key = "drive-single-brake_drag-telescope-5"
    (order,) = (o for o in SETS["everything"]() if o.key == key)
    seal(order, 1064, tmp_path / "logs", tmp_path / "truth")
    folder = tmp_path / "logs" / key
    calibrate(sorted(folder.glob("*.csv")), folder / "rig.yaml", [], tmp_path / "out", plots=False)
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    truth = json.loads((tmp_path / "truth" / f"{key}.json").read_text())
    (found,) = report["effects"]
    assert found["name"] == "brake_drag"
    assert found["parameters"]["torque"]["value"] == pytest.approx(
        truth["effects"][0]["raw"]["BRAKE_T"], rel=0.02
    )
    assert report["calibrated"]["torque_constant"]["value"] == pytest.approx(truth["drive"]["KA"], rel=0.01)
    assert any("currents stop at 8.19 A" in x for x in report["reasons"])
