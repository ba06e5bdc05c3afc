"""Friction that grows with the load that the drive carries."""

import numpy as np

from calibration.balances.slowoffset import SLOW
from calibration.names.name import Candidate, Name, Scene, candidate

#: terms that are no load: friction, and what the amplifier's zero does
NO_LOAD = ("coulomb", "viscous", "drift", SLOW)


def columns(s: Scene) -> list[Candidate]:
    """The load against the motion: from the motion, not from the response, whose noise it would share."""
    if s.pair is not None:  # through both trains, which pull against each other
        load = np.abs(s.pair.load) + 2 * np.abs(s.pair.lagging)
    elif lacks(s) or not s.both:
        return []
    else:  # all that the declared terms make but friction: an offset and a weight share what they make
        p, mass = s.problem, s.view.rig.constants.get("inertia", 0.0)
        carried = [k for k, (n, _) in enumerate(p.base_labels) if n not in NO_LOAD]
        sizes = np.array([s.declared[p.base_labels[k][0]] for k in carried])
        load = np.abs(p.base[:, carried] @ sizes + mass * s.at(s.view.second(s.view.x)))
    full = np.interp(np.arange(len(s.view.t)), s.view.rows, load)
    return [candidate(NAME.name, s.answer(full), "coefficient", sign=1, most=1.0)]


def lacks(s: Scene) -> str:
    """A load beside friction."""
    have = {"inertia", "gravity_cos"} & set(s.declared)
    return "" if have and s.view.dynamic else "a load beside friction: accelerations or a weight"


NAME = Name(name="load_friction", columns=columns, experiment="the same motion with two loads", lacks=lacks)
