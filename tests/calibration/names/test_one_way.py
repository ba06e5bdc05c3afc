"""A drag from some time on is a brake's only where the log turns both ways: else an offset changed."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import answer

RATE_HZ, SECONDS, BEGINS_S = 50.0, 240.0, 100.0
RIG = """rig: stand
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: deg}
  force: {column: u, unit: N m}
response: {channel: force, unit: N m}
estimate: [viscous, coulomb, offset]
"""


@pytest.mark.slow
@pytest.mark.parametrize("both", [True, False])
def test_a_brake_needs_both_directions(tmp_path: Path, both: bool) -> None:
    t = np.arange(0.0, SECONDS, 1 / RATE_HZ)
    rate = (
        90.0
        * (1.0 + 0.4 * np.sin(2 * np.pi * t / 37.0))
        * (np.sign(np.sin(2 * np.pi * t / 41.0)) if both else 1)
    )
    x = np.cumsum(rate) / RATE_HZ
    drag = 0.5 * (t > BEGINS_S)
    noise = 0.05 * np.random.default_rng(7).standard_normal(len(t))
    first = answer(tmp_path, RIG, (t, x, np.sign(rate) * (1.0 + drag) + 0.002 * rate + noise))["effects"][0]
    assert "brake_drag" in (first["name"], *first["equivalent"])
    assert (first["name"] == "unknown") is not both
    assert first["parameters"]["start"]["value"] == pytest.approx(BEGINS_S, abs=1.0)


@pytest.mark.slow
@pytest.mark.parametrize("both", [True, False])
def test_so_does_friction_that_warms_up(tmp_path: Path, both: bool) -> None:
    t = np.arange(0.0, SECONDS, 1 / RATE_HZ)
    rate = (
        90.0
        * (1.0 + 0.4 * np.sin(2 * np.pi * t / 37.0))
        * (np.sign(np.sin(2 * np.pi * t / 41.0)) if both else 1)
    )
    cold = 0.8 * np.exp(-t / 70.0)
    noise = 0.05 * np.random.default_rng(7).standard_normal(len(t))
    effort = np.sign(rate) * (1.0 + cold) + 0.002 * rate + noise
    first = answer(tmp_path, RIG, (t, np.cumsum(rate) / RATE_HZ, effort))["effects"][0]
    assert "friction_warmup" in (first["name"], *first["equivalent"]) or first["domain"] == "time"
    assert (first["name"] == "unknown") is not both
