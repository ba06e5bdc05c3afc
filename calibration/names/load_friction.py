"""Friction that grows with the load that the drive carries."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene


def columns(s: Scene) -> list[Candidate]:
    """|what accelerations and gravity need| against the motion: from the motion, not from the response, whose
    noise it would share."""
    v = s.view
    if lacks(s) or not s.both:
        return []
    load = s.declared["inertia"] * v.second(v.x) if "inertia" in s.declared else np.zeros(len(v.t))
    if "gravity_cos" in s.declared:
        from calibration.names.gravity_imbalance import gravity

        load = load + gravity(s) @ np.array([s.declared["gravity_cos"], s.declared["gravity_sin"]])
    from calibration.channels.view import smooth

    load = smooth(load, v.segment, max(v.sigma, 1.0))
    return [
        Candidate(
            "load_friction",
            "current",
            s.at(v.direction * np.abs(load))[:, None],
            (("coefficient", "1"),),
            sign=1,
            most=1.0,
        )
    ]


def lacks(s: Scene) -> str:
    """A load beside friction."""
    have = {"inertia", "gravity_cos"} & set(s.declared)
    return "" if have and s.view.dynamic else "a load beside friction: accelerations or a weight"


NAME = Name(
    "load_friction",
    (FORCE,),
    columns,
    ("viscous_change", "position_friction"),
    "the same motion with two loads",
    lacks,
)
