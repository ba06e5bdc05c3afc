"""Friction that falls as the motion begins."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene

PARTS = (0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.4)  # Stribeck speeds, of the top speed
CLEAR = 3.0  # of the speed at which the direction fades: below, a dip is only how friction turns
FEWEST = 0.005  # of the rows below the Stribeck speed


def columns(s: Scene) -> list[Candidate]:
    """sign(speed) exp(-(speed/vs)^2), for speeds on both sides of vs; only ever more friction at rest."""
    speed = np.abs(s.view.speed)
    top = float(np.quantile(speed[s.view.ok], 0.98)) if s.view.ok.any() else 0.0
    least = CLEAR * s.view.standstill
    out = []
    for part in PARTS:
        vs = part * top
        low = np.mean((speed < vs) & (speed > 0.1 * vs))
        if low < FEWEST or top < 2.5 * vs or vs < least:
            continue

        def full(p: np.ndarray) -> np.ndarray:
            return np.asarray(
                s.view.direction * np.exp(-((s.view.speed / max(p[0], least, 1e-9 * top)) ** 2))
            )

        shape = s.shaped(full)
        out.append(
            Candidate(
                "stribeck_change",
                "velocity",
                shape(np.array([vs])),
                (("stribeck_force", s.unit),),
                sign=1,
                fixed={"stribeck_speed": (vs, f"{s.angle_unit}/s")},
                shape=shape,
                steps=(0.1 * vs,),
                searched=1,
            )
        )
    return out


def lacks(s: Scene) -> str:
    """Speeds of more than one size."""
    speed = np.abs(s.view.speed[s.view.ok])
    if len(speed) and np.quantile(speed, 0.05) > 0.5 * np.quantile(speed, 0.98):
        return "slow motion: ramps through the lowest speeds"
    return ""


NAME = Name(
    "stribeck_change",
    (FORCE,),
    columns,
    ("presliding", "play"),
    "slow ramps on both sides of the Stribeck speed",
    lacks,
)
