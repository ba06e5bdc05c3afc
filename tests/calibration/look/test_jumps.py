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


def test_a_jump_is_not_hidden_by_what_looks_like_some(tmp_path: Path) -> None:
    """One of 3″ in half an hour; a gust of 1.6″ for a minute and a half, there and back, is none."""
    t = np.arange(0, 1800, 4.0)
    e = np.random.default_rng(1).normal(0, 0.5, len(t)) + 3.0 * (t > 400) + 1.6 * (abs(t - 1300) < 45)
    log = tmp_path / "log.txt"
    log.write_text(TOP + section("2026-01-01 20:00:00", t, e))
    assert calibrate([log], None, [], tmp_path / "out", plots=False) == 0
    (found,) = json.loads((tmp_path / "out" / "report.json").read_text())["effects"]
    ((size, when),) = re.findall(r"(\S+) arcsec at (\d+) s", found["note"])
    assert (float(size), float(when)) == (pytest.approx(3.0, abs=0.5), pytest.approx(400, abs=10))


@pytest.mark.slow
def test_a_log_without_jumps_has_none(tmp_path: Path) -> None:
    for seed in range(20):
        assert all(each["name"] != "unknown" for each in report(tmp_path, False, 0.0, seed)["effects"])
