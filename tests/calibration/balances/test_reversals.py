"""A motor that volts throw from one direction into the other: friction turns between two accelerations."""

from math import pi, sin, tanh
from pathlib import Path

import numpy as np
import pytest

from calibration.command import look
from calibration.finding import Finding
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.look.looked import Looked, Options

INERTIA, VISCOUS, COULOMB, CONSTANT, OHM = 0.002, 0.001, 0.05, 0.05, 1.0  # SI, of the motor below
LOOP = 2.0  # A s/rad, of its speed
TURNS = 0.05  # rad/s, over which its friction turns
PERIOD_S, ROWS, STEPS = 0.01, 6000, 20
COUNTS = 4096  # per turn
RIG = f"""
rig: motor
columns:
  time: {{column: t, unit: s}}
  position: {{column: position, unit: rad, scale: {2 * pi / COUNTS}}}
  effort: {{column: current, unit: A}}
response: {{channel: effort, unit: N m, gain: {CONSTANT}}}
estimate: [inertia, viscous, coulomb, offset]
stages:
  - {{name: motor, period: {2 * pi}, kind: motor_cogging, harmonics: 12}}
"""


def looked(folder: Path, cogging: float, cogs: int = 3, steady: float = 0.0) -> Looked:
    """The finder on a minute of volts in steps of either sign; or of a loop that holds a `steady` rad/s."""
    rng = np.random.default_rng(5)
    volts = np.repeat(rng.choice([-1, 1], 80) * rng.uniform(1.2, 2.2, 80), rng.integers(100, 400, 80))[:ROWS]
    rows, speed, angle, h = [], 0.0, 0.0, PERIOD_S / STEPS
    for k, u in enumerate(volts.tolist()):
        for _ in range(STEPS):
            current = LOOP * (steady - speed) if steady else (u - CONSTANT * speed) / OHM
            torque = CONSTANT * current - VISCOUS * speed - cogging * sin(cogs * angle)
            speed += h * (torque - COULOMB * tanh(speed / TURNS)) / INERTIA
            angle += h * speed
        rows.append(
            f"{k * PERIOD_S:.3f},{round(angle * COUNTS / 2 / pi)},{current + rng.normal(0, 0.02):.4f}"
        )
    (folder / "log.csv").write_text("\n".join(["t,position,current", *rows]) + "\n")
    (folder / "rig.yaml").write_text(RIG)
    drive = read_drive([folder / "log.csv"], load_rig(folder / "rig.yaml"))
    return look(drive, Options(hold_out=[], out=folder, plant=None, replay=False, tell=lambda _: None))


def sizes(found: Looked) -> dict[str, float]:
    """The declared terms' coefficients."""
    return {name: p.value for name, p in found.balances[0].numbers.items()}


@pytest.mark.slow
def test_friction_turns_at_the_row_at_which_the_drive_does(tmp_path: Path) -> None:
    found = looked(tmp_path, cogging=0.0)
    assert not found.effects
    assert sizes(found)["inertia"] == pytest.approx(INERTIA, rel=0.02)
    assert sizes(found)["coulomb"] == pytest.approx(COULOMB, rel=0.02)


@pytest.mark.slow
def test_cogging_that_the_rotor_follows_has_its_size(tmp_path: Path) -> None:
    found = looked(tmp_path, cogging=0.02)
    cog: Finding = found.effects[0]
    assert (cog.name, cog.harmonic) == ("motor_cogging", 3)
    assert cog.parameters["amplitude"].value == pytest.approx(0.02, rel=0.1)


@pytest.mark.slow
def test_cogging_at_one_speed_is_not_filtered_away(tmp_path: Path) -> None:
    """Six hertz, of which the filter that the position asks for leaves none: the current shows them."""
    found = looked(tmp_path, cogging=0.02, cogs=2, steady=20.0)
    first = found.effects[0]
    # at one speed and load a torque over the angle is cogging or ripple, of which the last digits decide
    assert "motor_cogging" in (first.name, *first.equivalent) and first.harmonic == 2
