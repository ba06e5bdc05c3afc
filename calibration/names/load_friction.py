"""Friction that grows with the load that the drive carries."""

import numpy as np

from calibration.names.name import Candidate, Name, Scene, candidate

#: declared terms that carry no load
FRICTION = ("coulomb", "viscous")


def columns(s: Scene) -> list[Candidate]:
    """The load against the motion: from the motion, not from the response, whose noise it would share."""
    if s.pair is not None:  # through both trains, which pull against each other
        load = np.abs(s.pair.load) + 2 * np.abs(s.pair.lagging)
    elif lacks(s) or not s.both:
        return []
    else:  # all that the declared terms make but friction: an offset and a weight share what they make
        p = s.problem
        friction = [s.declared[n] * p.base[:, p.place(n)] for n in FRICTION if n in s.declared]
        load = np.abs(s.declared_part - np.sum(friction, axis=0))
    full = np.interp(np.arange(len(s.view.t)), s.view.rows, load)
    return [candidate(NAME.name, s.answer(full), "coefficient", sign=1, most=1.0)]


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
