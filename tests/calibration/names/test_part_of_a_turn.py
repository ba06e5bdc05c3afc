"""Over part of a turn nothing comes again: harmonics are any function of the place, a weight is a weight."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import answer

SECONDS, RATE_HZ = 240.0, 50.0
SENSORS = """rig: two sensors
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: deg}
  position2: {column: u, unit: deg}
response: {channel: position2, unit: deg}
estimate: [offset]
stages:
  - {name: output, period: 360, harmonics: 4}
"""
JOINT = """rig: joint
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: deg}
  current: {column: u, unit: A}
response: {channel: current, unit: A}
estimate: [viscous, coulomb, offset]
stages:
  - {name: joint, period: 360, harmonics: 4}
"""


def swept(reach_turns: float) -> tuple[np.ndarray, np.ndarray]:
    """Time, and a position that goes to and fro over this much of a turn, deg."""
    t = np.arange(0.0, SECONDS, 1 / RATE_HZ)
    sway = 0.8 * np.sin(2 * np.pi * t / 23.0) + 0.2 * np.sin(2 * np.pi * t / 7.1)
    return t, 180.0 * reach_turns * sway


@pytest.mark.slow
@pytest.mark.parametrize(("width_deg", "reach_turns"), [(12.0, 0.6), (25.0, 0.6), (12.0, 1.3)])
def test_a_bump_between_two_sensors_is_no_runout(
    tmp_path: Path, width_deg: float, reach_turns: float
) -> None:
    t, x = swept(reach_turns)
    bump = 0.5 * np.exp(-0.5 * ((x - 20.0) / width_deg) ** 2)
    noise = 0.01 * np.random.default_rng(3).standard_normal(len(t))
    first = answer(tmp_path, SENSORS, (t, x, x + bump + noise))["effects"][0]
    assert (first["name"], first["domain"]) == ("unknown", "axis_angle")
    assert set(first["equivalent"]) <= {"encoder_eccentricity", "gear_eccentricity", "position_friction"}


def test_a_runout_over_whole_turns_has_its_harmonics(tmp_path: Path) -> None:
    t, x = swept(2.5)
    runout = 0.3 * np.cos(np.radians(x)) + 0.1 * np.cos(2 * np.radians(x) + 1.0)
    noise = 0.01 * np.random.default_rng(3).standard_normal(len(t))
    effects = answer(tmp_path, SENSORS, (t, x, x + runout + noise))["effects"]
    assert [(e["name"], e["harmonic"]) for e in effects[:2]] == [
        ("encoder_eccentricity", 1),
        ("encoder_eccentricity", 2),
    ]


@pytest.mark.slow
@pytest.mark.parametrize("reach_turns", [0.5, 0.9])
def test_a_weight_comes_before_harmonics_of_its_joint(tmp_path: Path, reach_turns: float) -> None:
    t, x = swept(reach_turns)
    rate = np.gradient(x, t)
    bends = np.sign(rate) * (1.0 + 0.2 * np.cos(3 * np.radians(x)))  # friction that is uneven over the stroke
    u = 10.0 * np.cos(np.radians(x) + 0.4) + bends + 0.002 * rate
    u += 0.05 * np.random.default_rng(5).standard_normal(len(t))
    first = answer(tmp_path, JOINT, (t, x, u))["effects"][0]
    assert first["name"] == "gravity_imbalance"
    assert first["parameters"]["amplitude"]["value"] == pytest.approx(10.0, rel=0.1)


@pytest.mark.slow
def test_a_weight_over_a_quarter_turn_is_no_pair_of_harmonics(tmp_path: Path) -> None:
    """Three and four cycles a turn are less than one over the stroke: together they are any curve."""
    t, x = swept(0.25)
    rate = np.gradient(x, t)
    u = 10.0 * np.cos(np.radians(x) + 0.4) + 0.3 * np.tanh(x / 20.0) + np.sign(rate) + 0.002 * rate
    u += 0.05 * np.random.default_rng(5).standard_normal(len(t))
    for effect in answer(tmp_path, JOINT, (t, x, u))["effects"]:
        assert not (effect["stage"] == "joint" and effect["name"] != "gravity_imbalance")
