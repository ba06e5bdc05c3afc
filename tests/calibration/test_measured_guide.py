"""Real guide logs: which worm or gear they show, and what it takes off frames that nothing was fitted to."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from calibration.command import calibrate

Array = NDArray[np.float64]
DATA = Path(__file__).parents[3] / "shared" / "data" / "measured" / "phd2"

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        not DATA.is_dir(), reason="../shared/data/measured is absent: no measured data to test on"
    ),
]


def report(out: Path, log: str, rig: Path | None = None) -> dict[str, Any]:
    assert calibrate([DATA / log], rig, [], out, plots=False) == 0
    data: dict[str, Any] = json.loads((out / "report.json").read_text())
    assert not any(c["accepted"] for c in data["controls"])
    return data


def drive_error(log: str, scale: float) -> tuple[Array, Array]:
    """t s and arcsec of an undithered log, by the sums of log-format.md alone."""
    with (DATA / log).open() as file:
        lines = [line for line in file if line[:1].isdigit() or line.startswith("Frame,")]
    rows = [r for r in csv.DictReader(lines) if r["mount"] == "Mount"]
    t = np.array([float(r["Time"]) for r in rows])
    sent = np.array([float(r["RAGuideDistance"]) * (r["RADuration"] not in ("0", "")) for r in rows])
    return t, scale * (np.array([float(r["RARawDistance"]) for r in rows]) + np.cumsum(sent) - sent)


def beside_a_drift(t: Array, y: Array, degree: int, *columns: Array) -> float:
    """rms of y beside a polynomial and columns."""
    x = (t - t.mean()) / np.ptp(t)
    base = np.column_stack([*(x**k for k in range(degree + 1)), *columns])
    return float(np.sqrt(np.mean((y - base @ np.linalg.lstsq(base, y, rcond=None)[0]) ** 2)))


@pytest.mark.parametrize(
    ("log", "scale", "period_s", "after"),
    [
        # px; aim of the requirement 1.2
        ("dataset01.csv", 1.0, 478.69, 1.2),
        # effects.md: 2.76 to 0.39 arcsec with the drift carried on from the fitted frames
        ("performance_dataset03.txt", 3.82, 382.95, 0.39),
        ("performance_dataset04.txt", None, 382.95, 0.8),  # dithered
    ],
)
def test_a_worm_is_named_and_pays_on_held_out_frames(
    tmp_path: Path, log: str, scale: float | None, period_s: float, after: float
) -> None:
    data = report(tmp_path, log)
    top = data["effects"][0]
    assert data["verdict"] == "found" and len(data["effects"]) == 1
    assert top["name"] == "gear_eccentricity" and top["stage"].startswith("worm")
    assert 1 / top["frequency_Hz"] == pytest.approx(period_s, rel=1e-4)
    error = data["error"]["position"]
    if scale is not None:
        t, y = drive_error(log, scale)
        degree = round(float(np.ptp(t)) / period_s)  # half as many waves as the worm has turns
        assert error["before"] == pytest.approx(beside_a_drift(t, y, degree), rel=0.05)
    assert error["after"] < after < error["before"]


def test_the_worm_of_the_heq5_is_not_supported_but_its_transfer_gear(tmp_path: Path) -> None:
    """A line at the gear's period takes more than at any other, by a least squares of one's own."""
    log = "performance_dataset02.txt"
    data = report(tmp_path, log)
    assert [e["stage"] for e in data["effects"]] == ["transfer gear of 122.2 s"]
    t, y = drive_error(log, 1.0)
    periods = np.geomspace(40.0, 900.0, 400)
    left = [beside_a_drift(t, y, 7, *(f(2 * np.pi * t / p) for f in (np.cos, np.sin))) for p in periods]
    assert periods[int(np.argmin(left))] == pytest.approx(122.2, rel=0.02)


def test_a_transfer_gear_is_found_in_a_log_with_32_dithers(tmp_path: Path) -> None:
    """README of the data: a gear of 122.2 s; 1.6 arcsec is what it must come down to.

    The worm's own turn gains little; its second and third harmonics stand beside it as narrow lines.
    """
    data = report(tmp_path, "performance_dataset06.txt")
    assert 1 / data["effects"][0]["frequency_Hz"] == pytest.approx(122.2, rel=2e-3)
    assert {e["stage"] for e in data["effects"]} <= {"transfer gear of 122.2 s", "worm of a 180-tooth wheel"}
    assert data["error"]["position"]["after"] < 1.6


def test_a_mount_is_declared_by_a_rig_file_too(tmp_path: Path) -> None:
    """One wheel instead of the family's two; the transfer gear keeps its name and its period."""
    rig = Path(__file__).parents[2] / "calibration" / "rigs" / "heq5_phd2.yaml"
    data = report(tmp_path, "performance_dataset06.txt", rig)
    assert "transfer" in {e["stage"] for e in data["effects"]}
    assert not {e["name"] for e in data["effects"]} - {"gear_eccentricity", "unknown"}
    assert data["error"]["position"]["after"] < 1.6  # arcsec, of 3.08
