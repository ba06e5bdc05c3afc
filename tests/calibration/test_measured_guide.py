"""Real guide logs: which worm or gear they show, and what it takes off frames that nothing was fitted to."""

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate

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


def held_out_without_a_model(log: str, scale: float, degree: int) -> float:
    """rms of the last 40 % of an undithered log about a polynomial, by the sums of log-format.md alone."""
    with (DATA / log).open() as file:
        lines = [line for line in file if line[:1].isdigit() or line.startswith("Frame,")]
    rows = [r for r in csv.DictReader(lines) if r["mount"] == "Mount"]
    t = np.array([float(r["Time"]) for r in rows])
    sent = np.array([float(r["RAGuideDistance"]) * (r["RADuration"] not in ("0", "")) for r in rows])
    y = scale * (np.array([float(r["RARawDistance"]) for r in rows]) + np.cumsum(sent) - sent)
    late = t > t[0] + 0.6 * (t[-1] - t[0])
    x = (t - t[late].mean()) / np.ptp(t[late])
    return float(np.std(y[late] - np.polyval(np.polyfit(x[late], y[late], degree), x[late])))


@pytest.mark.parametrize(
    ("log", "scale", "degree", "period_s", "after"),
    [
        # px; aim of the requirement 1.2
        ("dataset01.csv", 1.0, 3, 478.69, 1.2),
        # effects.md: 2.76 to 0.39 arcsec with the drift carried on from the fitted frames
        ("performance_dataset03.txt", 3.82, 2, 382.95, 0.39),
        ("performance_dataset04.txt", 2.66, None, 382.95, 0.8),
    ],
)
def test_a_worm_is_named_and_pays_on_held_out_frames(
    tmp_path: Path, log: str, scale: float, degree: int | None, period_s: float, after: float
) -> None:
    data = report(tmp_path, log)
    top = data["effects"][0]
    assert data["verdict"] == "found" and len(data["effects"]) == 1
    assert top["name"] == "gear_eccentricity" and top["stage"].startswith("worm")
    assert 1 / top["frequency_Hz"] == pytest.approx(period_s, rel=1e-4)
    error = data["error"]["position"]
    if degree is not None:
        assert error["before"] == pytest.approx(held_out_without_a_model(log, scale, degree), rel=0.05)
    assert error["after"] < after < error["before"]


def test_the_worm_of_the_heq5_is_not_supported(tmp_path: Path) -> None:
    data = report(tmp_path, "performance_dataset02.txt")
    assert data["verdict"] == "nothing" and data["effects"] == []


def test_a_transfer_gear_is_found_in_a_log_with_32_dithers(tmp_path: Path) -> None:
    """README of the data: a gear of 122.2 s, no worm; 1.6 arcsec is what it must come down to."""
    data = report(tmp_path, "performance_dataset06.txt")
    assert [1 / e["frequency_Hz"] for e in data["effects"]] == [pytest.approx(122.2, rel=2e-3)]
    assert data["effects"][0]["stage"] == "transfer gear of 122.2 s"
    assert data["error"]["position"]["after"] < 1.6


def test_a_mount_is_declared_by_a_rig_file_too(tmp_path: Path) -> None:
    """One wheel instead of the family's two; the transfer gear keeps its name and its period."""
    rig = Path(__file__).parents[2] / "calibration" / "rigs" / "heq5_phd2.yaml"
    data = report(tmp_path, "performance_dataset06.txt", rig)
    assert "transfer" in {e["stage"] for e in data["effects"]}
    assert not {e["name"] for e in data["effects"]} - {"gear_eccentricity", "unknown"}
    assert data["error"]["position"]["after"] < 1.6  # arcsec, of 3.08
