"""Friction that falls as the drive warms up."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

PARTS = (0.05, 0.1, 0.2, 0.4, 0.8)  # time constants, of the time from the first row to the last
LEAST_K = 0.5  # of temperature before its coefficient means anything


def columns(s: Scene) -> list[Candidate]:
    """Friction times exp(-time / tau), on the clock that all files share, or times the temperature."""
    v = s.view
    weight = v.direction * s.friction
    span = float(np.ptp(v.clock)) or 1.0
    start = v.clock - float(v.clock.min())

    def full(p: Array) -> Array:
        return np.asarray(weight * np.exp(-start / float(np.clip(p[0], 1e-3 * span, span))))

    shape = s.shaped(full)
    out = [
        Candidate(
            "friction_warmup",
            "time",
            shape(np.array([part * span])),
            (("relative_rise", "1"),),
            fixed={"tau": (part * span, "s")},
            sign=1,
            shape=shape,
            steps=(0.1 * part * span,),
            searched=1,
        )
        for part in PARTS
    ]
    t = v.columns.get("temperature")
    if t is not None and np.ptp(t) > LEAST_K:
        column = s.at(weight * (t - t.mean()))[:, None]
        label = (("relative_per_degree", "1/K"),)
        out.append(Candidate("friction_warmup", "temperature", column, label, sign=-1))
    return out


NAME = Name(
    "friction_warmup",
    (FORCE,),
    columns,
    ("preload_change", "brake_drag"),
    "repeat the same run after a rest of half an hour: a warm-up comes back",
)
