"""An effort that is late along one sine: its friction tells the time, though inertia is not to be had."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, MASS, PERIOD, VISCOUS, answer

HZ, LATE_S = 1.0, 0.04


@pytest.mark.slow
def test_a_late_effort_along_one_sine_is_found_by_its_friction(tmp_path: Path) -> None:
    """A light arm, whose inertia is a hundredth of what the late friction looks like."""
    t = np.arange(0, 30.0, PERIOD)
    files = []
    for k, size in enumerate((0.1, 0.2, 0.4)):
        x, ahead = (size * np.sin(2 * np.pi * HZ * (t + s)) for s in (0.0, LATE_S))
        speed = size * 2 * np.pi * HZ * np.cos(2 * np.pi * HZ * (t + LATE_S))
        noise = 0.02 * np.random.default_rng(k).standard_normal(len(t))
        files.append((t, x, -0.001 * ahead + COULOMB * np.sign(speed) + noise))
    data = answer(tmp_path, FORCE, *files)
    assert [e["name"] for e in data["effects"]] == ["channel_delay"]
    delay = data["effects"][0]["parameters"]["delay"]["value"]
    assert abs(delay) == pytest.approx(LATE_S, rel=0.05)


@pytest.mark.slow
def test_half_a_period_late_an_effort_is_late_and_not_against_the_motion(tmp_path: Path) -> None:
    t = np.arange(0, 40.0, PERIOD)
    late, files = 0.11, []
    for k, sizes in enumerate(((0.05, 0.03), (0.02, 0.05), (0.04, 0.04))):
        w = 2 * np.pi * np.array([3.0, 4.3])
        x = (np.array(sizes) * np.sin(np.outer(t, w))).sum(1)
        ahead = np.outer(t + late, w)
        v, a = (np.array(sizes) * w * np.cos(ahead)).sum(1), -(np.array(sizes) * w**2 * np.sin(ahead)).sum(1)
        noise = 0.02 * np.random.default_rng(k).standard_normal(len(t))
        files.append((t, x, MASS * a + VISCOUS * v + COULOMB * np.sign(v) + noise))
    data = answer(tmp_path, FORCE, *files)
    assert [e["name"] for e in data["effects"]] == ["channel_delay"]
    assert data["effects"][0]["parameters"]["delay"]["value"] == pytest.approx(-late, rel=0.03)
    assert data["calibrated"]["inertia"]["value"] == pytest.approx(MASS, rel=0.05)
    assert "against the motion" not in str(data)
