"""Jumps in a guide log: found where they are, with their sizes, beside a worm or alone."""

import json
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.balances.mounts import SIDEREAL_DAY_S
from calibration.command import calibrate
from tests.calibration.guidelogs import TOP, section

AT_S = (900.0, 2300.0, 3700.0)
SIZES = (4.0, -3.0, 5.0)


def report(folder: Path, jumps: bool, worm: float, seed: int) -> dict[str, Any]:
    """Of a section of 80 minutes: drift, a walk, seeing of 0.3″; a worm, ″; three jumps or none."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, 4800, 4.0)
    e = 0.002 * t + np.cumsum(rng.normal(0, 0.03, len(t))) + rng.normal(0, 0.3, len(t))
    e += worm * np.sin(2 * np.pi * 180 / SIDEREAL_DAY_S * t)
    for at, size in zip(AT_S, SIZES, strict=True):
        e += jumps * size * (t > at)
    log = folder / f"{seed}.txt"
    log.write_text(TOP + section("2026-01-01 20:00:00", t, e))
    assert calibrate([log], None, [], folder / "out", plots=False) == 0
    data: dict[str, Any] = json.loads((folder / "out" / "report.json").read_text())
    return data


@pytest.mark.parametrize("worm", [0.0, 3.0])
def test_jumps_are_told_with_time_and_size_and_pay_on_held_out_frames(tmp_path: Path, worm: float) -> None:
    data = report(tmp_path, True, worm, seed=3)
    (found,) = (each for each in data["effects"] if each["name"] == "unknown")
    assert found["domain"] == "time"
    told = re.findall(r"(\S+) arcsec at (\d+) s", found["note"])
    assert len(told) == len(AT_S)
    for (size, when), at, true in zip(told, AT_S, SIZES, strict=True):
        assert float(when) == pytest.approx(at, abs=10.0)
        assert float(size) == pytest.approx(true, abs=0.5)
    error = data["error"]["position"]
    assert error["after"] < 0.5 * error["before"]
    assert any(each["stage"] for each in data["effects"]) == (worm > 0)


@pytest.mark.slow
def test_a_log_without_jumps_has_none(tmp_path: Path) -> None:
    for seed in range(20):
        assert all(each["name"] != "unknown" for each in report(tmp_path, False, 0.0, seed)["effects"])
