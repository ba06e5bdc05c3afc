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
    """Friction, or what of it knows no speed, times exp(-time / tau), on the clock that all files share or
    from the start of every file, or times the temperature."""
    v = s.view
    weight = v.direction * s.friction
    weights = {"relative_rise": weight}
    if s.declared.get("coulomb", 0.0) > 0 and s.declared.get("viscous", 0.0) > 0:
        weights["relative_rise_of_coulomb"] = v.direction * s.declared["coulomb"]
    out = []
    for label, w in weights.items():
        out += _cooling(s, w, v.clock - float(v.clock.min()), label, "tau")
        if len(np.unique(v.file)) > 1:
            out += _cooling(s, w, v.t, label, "tau_in_run")
    t = v.columns.get("temperature")
    if t is not None and np.ptp(t) > LEAST_K:
        column = s.at(weight * (t - t.mean()))[:, None]
        per_degree = (("relative_per_degree", "1/K"),)
        out.append(Candidate("friction_warmup", "temperature", column, per_degree, sign=-1))
    return out


def _cooling(s: Scene, weight: Array, since: Array, label: str, name: str) -> list[Candidate]:
    """`weight` (full rate) times exp(-since / tau) for the time constants that are tried; `label` is the
    size's name, `name` the time constant's."""
    span = float(since.max()) or 1.0

    def full(p: Array) -> Array:
        return np.asarray(weight * np.exp(-since / float(np.clip(p[0], 1e-3 * span, span))))

    shape = s.shaped(full)
    return [
        Candidate(
            "friction_warmup",
            "time",
            shape(np.array([part * span])),
            ((label, "1"),),
            fixed={name: (part * span, "s")},
            sign=1,
            shape=shape,
            steps=(0.1 * part * span,),
            searched=1,
        )
        for part in PARTS
    ]


NAME = Name(
    "friction_warmup",
    (FORCE,),
    columns,
    ("preload_change", "brake_drag"),
    "repeat the same run after a rest of half an hour: a warm-up comes back",
)
