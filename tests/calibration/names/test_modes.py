"""A second mass in a swept sine, whose moves are mostly quicker than the mode."""

from pathlib import Path

import numpy as np
import pytest
from scipy.signal import chirp, lsim

from tests.calibration.test_drives import COULOMB, FORCE, MASS, VISCOUS, answer

PERIOD_S = 0.002
HERTZ, DAMPING, SECOND_KG = 2.5, 0.02, 1.6


def sweep(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, position and force of a sweep that begins anywhere between 0.4 and 0.8 Hz."""
    rng = np.random.default_rng(seed)
    t = np.arange(0, 5.0, PERIOD_S)
    x = 0.02 * chirp(t, rng.uniform(0.4, 0.8), 5.0, rng.uniform(10.0, 14.0), method="logarithmic", phi=-90)
    v, w = np.gradient(x, PERIOD_S), 2 * np.pi * HERTZ
    _, second, _ = lsim(([2 * DAMPING * w, w * w], [1.0, 2 * DAMPING * w, w * w]), v, t)
    force = MASS * np.gradient(v, PERIOD_S) + SECOND_KG * np.gradient(second, PERIOD_S) + VISCOUS * v
    force += COULOMB * np.sign(v) + 0.1 * rng.standard_normal(len(t))
    return t, x + 2e-6 * rng.standard_normal(len(t)), force


@pytest.mark.slow
@pytest.mark.parametrize("seed", [1, 2])
def test_a_mode_in_a_sweep_has_its_frequency_and_mass(tmp_path: Path, seed: int) -> None:
    data = answer(tmp_path, FORCE, *(sweep(10 * seed + k) for k in range(3)))
    top = data["effects"][0]
    assert top["name"] == "structural_mode" and top["equivalent"] == []
    assert top["parameters"]["frequency"]["value"] == pytest.approx(HERTZ, rel=0.02)
    assert top["parameters"]["inertia"]["value"] == pytest.approx(SECOND_KG, rel=0.1)
    assert data["error"]["torque"]["after"] < 0.2 * data["error"]["torque"]["before"]
