"""Friction that is nearly all over the place, bristles softer than any spring, a quick encoder's rounding."""

from pathlib import Path

import numpy as np
import pytest

from calibration.balances.noise import position_noise
from calibration.inputs.run import quantum
from tests.calibration.test_drives import PERIOD, answer, found
from tests.calibration.test_friction_law import COULOMB, MASS, RIG, TRAVEL, VISCOUS

ORDER = 1.7  # waves per rad, which no stage has


def moved(seed: int) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Time, angle, and rate and effort of the mass and its viscous friction over 60 s."""
    t = np.arange(0.0, 60.0, PERIOD)
    rng = np.random.default_rng(seed)
    w, size = 2 * np.pi * np.array([0.05, 0.13]), np.array([1.5, 0.5])
    at = rng.uniform(0, 2 * np.pi, 2)
    x, v, a = ((size * w**k * np.sin(np.outer(t, w) + at + k * np.pi / 2)).sum(1) for k in range(3))
    return t, x, v, MASS * a + VISCOUS * v + 0.02 * rng.standard_normal(len(t))


@pytest.mark.slow
def test_friction_over_the_place_may_be_nine_tenths_of_it(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, v, u = moved(k)
        friction = COULOMB * (1 + 0.9 * np.cos(2 * np.pi * ORDER * x + 0.4))
        tables.append((t, np.round(x, 6), u + friction * np.sign(v)))
    data = answer(tmp_path, RIG, *tables)
    assert found(data) == ["position_friction"]
    assert data["effects"][0]["parameters"]["amplitude"]["value"] == pytest.approx(0.9 * COULOMB, rel=0.05)


@pytest.mark.slow
def test_bristles_that_give_way_by_and_by_have_their_travel(tmp_path: Path) -> None:
    tables = []
    for k in range(3):
        t, x, _, u = moved(k)
        z = np.zeros(len(x))
        for j, step in enumerate(np.diff(x), start=1):  # Dahl's law, exact for a constant rate within a row
            end = np.sign(step)
            z[j] = end + (z[j - 1] - end) * np.exp(-abs(step) / TRAVEL)
        tables.append((t, np.round(x, 6), u + COULOMB * z))
    data = answer(tmp_path, RIG, *tables)
    first = data["effects"][0]
    assert first["name"] == "presliding"
    assert first["parameters"]["bristle_travel"]["value"] == pytest.approx(TRAVEL, rel=0.05)
    assert data["error"]["torque"]["after"] < 1.5 * data["error"]["torque"]["floor"]


def test_a_quick_encoders_rounding_is_its_count() -> None:
    """One step in a hundred is of one count: the 2 % smallest of them are of two."""
    rng = np.random.default_rng(3)
    x = np.round(np.cumsum(rng.uniform(0.6, 90.0, 20_000)))
    assert quantum(x) == 1.0
    smooth = np.round(2e6 * np.sin(np.linspace(0, 20, 20_000)))
    assert position_noise(smooth, np.zeros(20_000, dtype=np.int64)) < 3 / np.sqrt(12)
