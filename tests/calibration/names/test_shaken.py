"""A disturbance at a fixed frequency that shakes the drive, too: its loop hardly holds against it."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import COULOMB, FORCE, MASS, PERIOD, VISCOUS, answer

HERTZ, NEWTON = 7.3, 1.0
STEPS = 20  # of the simulation per row


def shaken(seconds: float, seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, position and force of a mass in a stiff loop behind a smooth set point."""
    t, h = np.arange(0, seconds, PERIOD), PERIOD / STEPS
    x, v, rows = 0.0, 0.0, []
    for now in t:
        want = 0.3 * np.sin(2 * np.pi * 0.3 * now) + 0.15 * np.sin(2 * np.pi * 0.83 * now + 1)
        force = 1000 * (want - x) - 60 * v
        rows.append((x, force))
        for k in range(STEPS):
            friction = COULOMB * np.tanh(v / 1e-3) + VISCOUS * v
            v += h * (force - friction - NEWTON * np.sin(2 * np.pi * HERTZ * (now + k * h))) / MASS
            x += h * v
    noise = np.random.default_rng(seed).standard_normal(len(t))
    at, force = np.array(rows).T
    return t, np.round(at / 1e-5) * 1e-5, force + 0.05 * noise


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_disturbance_that_moves_the_drive_is_found(tmp_path: Path, seed: int) -> None:
    """Motion that nearly repeats itself has a multiple near any frequency."""
    data = answer(tmp_path, FORCE, shaken(45.0, seed))
    top = data["effects"][0]
    assert "command_disturbance" in (top["name"], *top["equivalent"])
    assert top["frequency_Hz"] == pytest.approx(HERTZ, abs=0.02)
    assert top["parameters"]["amplitude"]["value"] == pytest.approx(NEWTON, rel=0.1)
    assert data["error"]["torque"]["after"] < 0.2 * data["error"]["torque"]["before"]
