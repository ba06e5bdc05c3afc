"""More friction one way than the other."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene

VARIES = 0.1  # of the mean speed: below, a part that grows with the speed is the constant one


def columns(s: Scene) -> list[Candidate]:
    """|direction|, and with it |speed|: even in direction, gone at rest."""
    if not s.both:
        return []
    one, speed = np.abs(s.view.direction), np.abs(s.view.speed)
    per = f"{s.unit} s/{s.angle_unit}"
    # beyond the declared friction itself, it would push one way
    most = tuple(max(s.declared.get(n, np.inf), 0.0) or np.inf for n in ("coulomb", "viscous"))
    label = (("coulomb_asymmetry", s.unit), ("viscous_asymmetry", per))
    out = []
    # where nothing stands still, a constant is the offset of the base
    if np.std(s.at(one)) > 0.02:
        c = s.at(one)[:, None]
        out.append(Candidate("friction_asymmetry", "velocity", c, label[:1], most=most[0]))
    if np.std(speed) > VARIES * np.mean(speed):
        grows = s.at(speed)[:, None]
        out.append(Candidate("friction_asymmetry", "velocity", grows, label[1:], most=most[1]))
        if len(out) > 1:
            both = s.at(np.column_stack([one, speed]))
            out.append(Candidate("friction_asymmetry", "velocity", both, label, most=most))
    return out


def lacks(s: Scene) -> str:
    """Both directions."""
    return "" if s.both else "motion in both directions"


NAME = Name(
    "friction_asymmetry",
    (FORCE,),
    columns,
    ("adc_offset",),
    "run both directions at two speeds, and read the effort at rest",
    lacks,
)
