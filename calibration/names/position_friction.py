"""Friction that changes over the position."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.names.sines import as_one, over_place
from calibration.readers.run import Array

HARMONICS = 3  # of the travelled range, and up to 12 of every stage
WAVES = np.arange(0.75, 12.1, 0.5)  # over the travelled range, of a friction that follows no stage
BESIDE = 2.0  # of the friction that is fitted without the effect: what it may be beside it. ASSUMPTION
STEP = 0.1  # of a wave over the range: a small one


def columns(s: Scene) -> list[Candidate]:
    """Sines over the range, over every slow stage, and of any length, odd in direction."""
    if not s.both or s.span <= 0:
        return []
    v = s.view
    period = min(s.span, v.turn or s.span)
    # friction that changes its sign would feed energy; how much there is is known beside the effect
    most = BESIDE * s.declared.get("coulomb", 0.0) or np.inf
    blank = Candidate(
        "position_friction",
        "axis_angle",
        np.zeros((len(v.rows), 0)),
        (("amplitude", s.unit),),
        kind="line",
        stage="axis",
        most=most,
    )
    out = []
    for h in range(1, HARMONICS + 1):
        rate = h / period
        out.append(replace(blank, columns=_waves(s, rate), harmonic=h, order=rate * (v.turn or 1.0)))
    for g in v.rig.stages:
        mine: list[Candidate] = []
        for h in range(1, min(g.harmonics, 12) + 1) if g.period else ():
            rate = h / float(g.period or 1.0)
            one = replace(blank, stage=g.name, harmonic=h, order=rate * (v.turn or 1.0))
            if s.span * rate > 1.5:
                mine += over_place(s, one, rate, v.direction)
        out += [*mine, *as_one(mine)]
    return out + _of_any_length(s, blank)


def _waves(s: Scene, rate: float) -> Array:
    phase = 2 * np.pi * s.view.x * rate
    d = s.view.direction
    return s.at(np.column_stack([d * np.cos(phase), d * np.sin(phase)]))


def _of_any_length(s: Scene, blank: Candidate) -> list[Candidate]:
    """Waves over the range whose length is fitted."""
    unit = s.view.turn or 1.0

    def shape(p: Array) -> Array:
        return _waves(s, float(p[0]) / unit)

    return [
        replace(
            blank,
            columns=shape(np.array([w / s.span * unit])),
            fixed={"order": (w / s.span * unit, "1")},
            shape=shape,
            steps=(STEP / s.span * unit,),
            searched=1,
        )
        for w in WAVES
    ]


def lacks(s: Scene) -> str:
    """Both directions."""
    return "" if s.both else "motion in both directions over the same place"


NAME = Name(
    "position_friction",
    (FORCE,),
    columns,
    ("gear_eccentricity", "motor_cogging"),
    "go there and back over the same place: friction changes its sign, a gear or cogging does not",
    lacks,
)
