"""Friction that changes over the position."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate, sine_columns
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene

HARMONICS = 3  # of the travelled range, and up to 12 of every stage


def columns(s: Scene) -> list[Candidate]:
    """Sines over the range and over every slow stage, odd in direction."""
    if not s.both or s.span <= 0:
        return []
    v = s.view
    period = min(s.span, v.turn or s.span)
    most = s.declared.get("coulomb", 0.0) or np.inf  # friction that changes its sign would feed energy
    places = [(h / period, "axis", h, False) for h in range(1, HARMONICS + 1)]
    for g in v.rig.stages:
        if g.period:
            places += [
                (h / g.period, g.name, h, True)
                for h in range(1, min(g.harmonics, 12) + 1)
                if s.span * h / g.period > 1.5
            ]
    out = []
    sessions = s.session
    for rate, stage, h, own in places:
        phase = 2 * np.pi * v.x * rate
        pair = s.at(np.column_stack([v.direction * np.cos(phase), v.direction * np.sin(phase)]))
        if own and len(np.unique(sessions)) > 1:
            pair = sine_columns(v.x[v.rows] * rate, sessions, s.at(v.direction))
        out.append(
            Candidate(
                "position_friction",
                "axis_angle",
                pair,
                (("amplitude", s.unit),),
                kind="line",
                stage=stage,
                harmonic=h,
                order=rate * (v.turn or 1.0),
                most=most,
            )
        )
    for g in v.rig.stages:
        mine = [c for c in out if c.stage == g.name]
        if len(mine) > 1:  # several hide each other when taken one by one
            whole = np.hstack([c.columns for c in mine])
            out.append(replace(mine[0], columns=whole, harmonic=None, searched=1))
    return out


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
