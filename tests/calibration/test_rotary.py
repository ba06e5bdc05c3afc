"""A rotary drive of any rig file: a damaged tooth of a part, a cable bundle about the axis."""

from pathlib import Path

import numpy as np
import pytest

from calibration.balances.recursions import stop_operator
from tests.calibration.test_drives import COULOMB, PERIOD, VISCOUS, answer, found

RIG = """rig: turntable behind a pinion
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  effort: {column: u, unit: N m}
response: {channel: effort, unit: N m}
estimate: [inertia, viscous, coulomb, offset]
stages:
  - {name: pinion, period: 0.9, harmonics: 2}
"""
INERTIA = 2.0


def night(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, angle (steps of 1e-5) and effort of 60 s, two thirds of a turn to either side."""
    t = np.arange(0.0, 60.0, PERIOD)
    rng = np.random.default_rng(seed)
    w, size = 2 * np.pi * np.array([0.05, 0.13]), np.array([3.0, 1.0])
    at = rng.uniform(0, 2 * np.pi, 2)
    x = (size * np.sin(np.outer(t, w) + at)).sum(1)
    v = (size * w * np.cos(np.outer(t, w) + at)).sum(1)
    a = -(size * w**2 * np.sin(np.outer(t, w) + at)).sum(1)
    u = INERTIA * a + VISCOUS * v + COULOMB * np.sign(v) + 0.02 * rng.standard_normal(len(t))
    return t, np.round(x, 5), u


@pytest.mark.slow
def test_a_sound_one_has_neither(tmp_path: Path) -> None:
    assert found(answer(tmp_path, RIG, *[night(k) for k in range(3)])) == []


@pytest.mark.slow
def test_a_damaged_tooth_is_a_pulse_at_one_place_of_its_part(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, u = night(k)
        away = (x / 0.9 - 0.3 + 0.5) % 1.0 - 0.5
        tables.append((t, x, u - 0.8 * np.exp(-0.5 * (away / 0.02) ** 2)))  # 0.8 N m the way the axis counts
    data = answer(tmp_path, RIG, *tables)
    (tooth,) = data["effects"]
    assert (tooth["name"], tooth["stage"]) == ("damaged_tooth", "pinion")
    assert tooth["parameters"]["amplitude"]["value"] == pytest.approx(0.8, rel=0.1)
    assert tooth["parameters"]["phase"]["value"] == pytest.approx(0.3, abs=0.005)
    assert data["error"]["torque"]["after"] < 0.4 * data["error"]["torque"]["before"]


@pytest.mark.slow
def test_a_cable_bundle_pulls_back_and_loops(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, u = night(k)
        loop = stop_operator(x, np.zeros(len(x), dtype=np.int64), 0.1) / 0.1
        tables.append((t, x, u + 0.5 * x + 0.4 * loop))
    data = answer(tmp_path, RIG, *tables)
    assert "cable_wrap" in found(data)[0:1] or "cable_wrap" in data["effects"][0]["equivalent"]
    assert data["effects"][0]["parameters"]["stiffness"]["value"] == pytest.approx(0.5, rel=0.05)
    assert data["error"]["torque"]["after"] < 0.1 * data["error"]["torque"]["before"]
