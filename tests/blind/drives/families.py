"""Drives as publications describe them; every draw lies within a factor of two of a published one."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

Rng = np.random.Generator


@dataclass(frozen=True)
class Family:
    """One kind of drive: its units, its log, what a user would declare of it, and how it is drawn.

    step: of the position sensor, position units. effort_step: of the logged effort. noise: rms of the logged
    effort, of TOP. travel, speed: of the reference. turn: position units per turn of the periodic part that
    its maker tells (`stage`).
    """

    name: str
    position: str
    force: str
    effort: str
    period_s: float
    step: float
    effort_step: float
    noise: float
    travel: tuple[float, float]
    speed: tuple[float, float]
    stage: str
    turn: tuple[float, float]
    draw: Callable[[Rng], dict[str, float]]


def near(rng: Rng, value: float, factor: float = 1.6) -> float:
    """A value within a factor of the published one."""
    return float(value * factor ** rng.uniform(-1.0, 1.0))


def friction(
    rng: Rng, coulomb: float, viscous: float, stribeck: float, break_away: float
) -> dict[str, float]:
    """Friction about published figures; the bristle gives way after `break_away` of travel, less than a step
    of the sensor: where nothing is hidden, it is the Coulomb and viscous friction that the rig file declares.
    """
    c = near(rng, coulomb)
    return {
        "COUL": c, "STIC": c, "VISC": near(rng, viscous), "VS": near(rng, stribeck),
        "SIG0": c / near(rng, break_away),
    }  # fmt: skip


def ball_screw(rng: Rng) -> dict[str, float]:
    """EMPS: Janot, Gautier, Brunot 2019 (95 kg, 203 N s/m, 20 N, 35 N/V, cascade 160 1/s and 243 V s/m)."""
    return friction(rng, 20.0, 203.0, 2e-3, 2e-6) | {
        "MASS": near(rng, 95.0), "GAIN": 35.15, "KP": near(rng, 160.0, 1.2), "KV": near(rng, 243.0, 1.2),
        "CASCADE": 1.0, "TOP": 10.0,
    }  # fmt: skip


def belt(rng: Rng) -> dict[str, float]:
    """Linear axis with toothed belt: 4 kg, 20 N s/m, 10 N (Sollmann, Jouaneh, Lavender 2010, order of)."""
    mass = near(rng, 4.0)
    return friction(rng, 10.0, 20.0, 5e-3, 1e-5) | {
        "MASS": mass, "GAIN": 20.0, "KP": mass * 120.0, "KD": mass * 5.0, "KI": mass * 300.0, "TOP": 10.0,
    }  # fmt: skip


def servo(rng: Rng) -> dict[str, float]:
    """Geared servo with a pendulum: Dynamixel XL330, reflected rotor and 0.49 kg at 0.1 m (Rhoban BAM)."""
    return friction(rng, 0.06, 0.05, 0.1, 3e-4) | {
        "MASS": near(rng, 0.009), "GAIN": 0.6, "KP": near(rng, 6.0), "KD": 0.08, "TOP": 1.0,
    }  # fmt: skip


def table(rng: Rng) -> dict[str, float]:
    """Direct-drive rotary table: 0.2 kg m2, 0.5 N m, 0.5 N m s (brushless torque motors' data sheets)."""
    inertia = near(rng, 0.2)
    return friction(rng, 0.5, 0.5, 0.02, 5e-5) | {
        "MASS": inertia, "GAIN": 5.0, "KP": inertia * 500.0, "KD": inertia * 12.0, "KI": inertia * 2000.0,
        "TOP": 10.0,
    }  # fmt: skip


FAMILIES: dict[str, Family] = {
    f.name: f
    for f in (
        Family("ball_screw", "m", "N", "V", 0.002, 1e-7, 5e-4, 0.002, (0.08, 0.25), (0.04, 0.2),
            "screw", (0.005, 0.01), ball_screw),
        Family("belt", "m", "N", "V", 0.002, 5e-6, 3e-3, 0.003, (0.2, 0.8), (0.1, 0.6),
            "pulley", (0.06, 0.15), belt),
        Family("servo", "rad", "N m", "duty", 0.005, 2 * np.pi / 4096, 1e-3, 0.003, (0.8, 2.5), (0.5, 2.5),
            "output", (2 * np.pi, 2 * np.pi), servo),
        Family("table", "rad", "N m", "A", 0.001, 2 * np.pi / 2**20, 2e-3, 0.002, (1.5, 6.0), (0.4, 2.0),
            "motor", (2 * np.pi, 2 * np.pi), table),
    )
}  # fmt: skip
