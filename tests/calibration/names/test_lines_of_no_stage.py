"""A line at an order that no declared stage has: a bearing only where the gear table is there to say so."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.calibration.test_drives import answer

RATE_HZ, SECONDS = 100.0, 240.0
RIG = """rig: geared bench
columns:
  time: {{column: t, unit: s}}
  position: {{column: x, unit: deg}}
  effort: {{column: u, unit: N m}}
response: {{channel: effort, unit: N m}}
estimate: [viscous, coulomb, offset]
turn: 360
stages:
{stages}
"""
SHAFT = "  - {name: shaft, period: 360, harmonics: 12}"
TRAIN = "\n  - {name: pinion, of: shaft, teeth: [70, 10], harmonics: 1}"
MOTOR = "  - {name: motor, period: 360, harmonics: 4, kind: motor_cogging}"


def told(folder: Path, stages: str, order: float) -> dict[str, Any]:
    """The first effect of a log with a line of this order per turn of the position, to and fro."""
    t = np.arange(0.0, SECONDS, 1 / RATE_HZ)
    x = 900.0 * (np.sin(2 * np.pi * t / 60.0) + 0.3 * np.sin(2 * np.pi * t / 17.0))
    rate = np.gradient(x, t)
    noise = 0.02 * np.random.default_rng(8).standard_normal(len(t))
    u = np.sign(rate) + 0.001 * rate + 0.3 * np.cos(2 * np.pi * order * x / 360.0 + 1.0) + noise
    data = answer(folder, RIG.format(stages=stages), (t, x, u))
    first: dict[str, Any] = data["effects"][0]
    return first


@pytest.mark.slow
@pytest.mark.parametrize(
    ("stages", "order", "name", "stage"),
    [
        (
            SHAFT,
            20.0,
            "gear_eccentricity",
            "shaft",
        ),  # a harmonic that was not declared, or a part of 20 turns
        (SHAFT, 19.37, "gear_eccentricity", None),  # a part of no declared train
        (SHAFT + TRAIN, 19.37, "bearing_pass", None),
        (SHAFT + TRAIN, 14.0, "gear_eccentricity", "pinion"),
        (MOTOR, 9.37, "bearing_pass", None),
        (MOTOR, 9.0, "motor_cogging", "motor"),
    ],
)
def test_a_whole_multiple_of_a_stage_is_its_harmonic_first(
    tmp_path: Path, stages: str, order: float, name: str, stage: str | None
) -> None:
    first = told(tmp_path, stages, order)
    assert (first["name"], first["stage"]) == (name, stage)
    assert first["order"] == pytest.approx(order, abs=0.01)
    assert ("bearing_pass" in first["equivalent"]) is (name != "bearing_pass")
    if stage:
        assert first["harmonic"] == {20.0: 20, 14.0: 2, 9.0: 9}[order]


@pytest.mark.slow
def test_once_per_turn_of_a_motor_its_own_force_comes_first(tmp_path: Path) -> None:
    first = told(tmp_path, MOTOR, 1.0)
    assert (first["name"], first["stage"], first["harmonic"]) == ("motor_cogging", "motor", 1)
    assert first["equivalent"] == ["gravity_imbalance"]


@pytest.mark.slow
def test_a_stage_that_was_guessed_is_a_gear_or_a_motor(tmp_path: Path) -> None:
    first = told(tmp_path, "  - {name: shaft, period: 360, harmonics: 12, kind: unknown}", 6.0)
    assert (first["name"], first["stage"], first["harmonic"]) == ("gear_eccentricity", "shaft", 6)
    assert set(first["equivalent"]) == {"gear_mesh", "motor_cogging"}


@pytest.mark.slow
def test_a_speed_as_the_response_has_no_weight(tmp_path: Path) -> None:
    t = np.arange(0.0, SECONDS, 1 / RATE_HZ)
    x = 50.0 * t
    v = 50.0 + 0.5 * np.cos(np.radians(x)) + 0.05 * np.random.default_rng(8).standard_normal(len(t))
    rig = """rig: motor at one speed
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: deg}
  velocity: {column: u, unit: deg/s}
response: {channel: velocity, unit: deg/s}
estimate: [offset]
stages:
  - {name: shaft, period: 360, harmonics: 4}
"""
    names = {n for e in answer(tmp_path, rig, (t, x, v))["effects"] for n in (e["name"], *e["equivalent"])}
    assert "gear_eccentricity" in names and "gravity_imbalance" not in names
