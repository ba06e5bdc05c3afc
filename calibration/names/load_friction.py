"""Friction that grows with the load that the drive carries."""

import numpy as np

from calibration.balances.filters import smooth
from calibration.names.gravity_imbalance import gravity
from calibration.names.name import Candidate, Name, Scene, candidate


def columns(s: Scene) -> list[Candidate]:
    """The load against the motion: from the motion, not from the response, whose noise it would share."""
    if s.pair is not None:  # through both trains, which pull against each other
        both, m = np.abs(s.pair.load) + 2 * np.abs(s.pair.lagging), s.pair.motion
        load = np.interp(np.arange(len(m.x)), m.rows, both)
    elif lacks(s) or not s.both:
        return []
    else:  # what accelerations and gravity need
        v, load = s.view, s.declared.get("inertia", 0.0) * s.view.second(s.view.x)
        if "gravity_cos" in s.declared:
            load = load + gravity(s) @ np.array([s.declared["gravity_cos"], s.declared["gravity_sin"]])
        load = np.abs(smooth(load, v.segment, max(v.wide, 1.0)))
    return [candidate(NAME.name, s.answer(load), "coefficient", sign=1, most=1.0)]


def lacks(s: Scene) -> str:
    """A load beside friction."""
    have = {"inertia", "gravity_cos"} & set(s.declared)
    return "" if have and s.view.dynamic else "a load beside friction: accelerations or a weight"


NAME = Name(
    name="load_friction",
    columns=columns,
    experiment="the same motion with two loads",
    lacks=lacks,
)
