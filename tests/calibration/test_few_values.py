"""A relay's effort of two values: its motion tells what is missing, and how late the relay acts."""

from pathlib import Path

import numpy as np
import pytest

from tests.calibration.test_drives import FORCE, answer

STEP_S, EVERY = 0.0005, 10  # of the simulation, rows of the log
MASS, VISCOUS, PUSH_N = 2.0, 4.0, 6.0
NEAR = 0.05  # of the true size
NO_COULOMB = FORCE.replace(" coulomb,", "")


def relay(coulomb: float = 0.0, late_s: float = 0.0, seconds: float = 60.0) -> tuple[np.ndarray, ...]:
    """Time, position, and a relay's force that acts late on a mass with friction; Euler's steps."""
    rng = np.random.default_rng(7)
    n = int(seconds / STEP_S)
    held = np.repeat(rng.choice([-1.0, 1.0], n // 400 + 1), 400)[:n] * PUSH_N
    acts = np.roll(held, round(late_s / STEP_S))
    x = np.zeros(n)
    v = 0.0
    for k in range(1, n):
        push = acts[k] - VISCOUS * v
        brake = np.clip(v * MASS / STEP_S + push, -coulomb, coulomb)
        v += STEP_S * (push - brake) / MASS
        x[k] = x[k - 1] + STEP_S * v
    x = x + 1e-6 * rng.standard_normal(n)
    return np.arange(n)[::EVERY] * STEP_S, x[::EVERY], held[::EVERY]


@pytest.mark.slow
def test_a_sound_drive_under_a_relay_lacks_nothing(tmp_path: Path) -> None:
    data = answer(tmp_path, NO_COULOMB, relay())
    assert data["effects"] == []
    numbers = {name: data["calibrated"][name]["value"] for name in ("applied", "viscous")}
    assert numbers == pytest.approx({"applied": 1 / MASS, "viscous": VISCOUS / MASS}, rel=NEAR)
    assert "effort holds 2 values, the model has 3 terms: the acceleration is explained" in str(data)


@pytest.mark.slow
def test_friction_that_a_relay_overcomes_has_its_name_and_size(tmp_path: Path) -> None:
    data = answer(tmp_path, NO_COULOMB, relay(coulomb=2.0))
    assert [e["name"] for e in data["effects"]] == ["coulomb_change"]
    found = data["effects"][0]["parameters"]["coulomb_change"]["value"]
    assert found == pytest.approx(2.0 / MASS, rel=NEAR)


@pytest.mark.slow
def test_a_relay_that_acts_late_is_told_so(tmp_path: Path) -> None:
    data = answer(tmp_path, FORCE, relay(coulomb=2.0, late_s=0.03))
    assert [e["name"] for e in data["effects"]] == ["channel_delay"]
    found = data["effects"][0]["parameters"]["delay"]
    half = STEP_S * EVERY / 2  # a held value switches anywhere between two rows
    assert found["value"] == pytest.approx(-0.03 - half, abs=half)
    assert "the applied column is early" in data["effects"][0]["note"]
