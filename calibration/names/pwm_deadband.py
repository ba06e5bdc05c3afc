"""Volts that every pulse of a bridge loses, whatever its length: a dead time, or drops of its switches."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.electrical import KNEES
from calibration.channels.volts import volts_of
from calibration.names.name import VOLTS, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

MOST = 0.2  # of the supply. ASSUMPTION: a bridge that loses more is broken


def columns(s: Scene) -> list[Candidate]:
    """The supply in the direction of the duty, in proportion below the dead band; u = R i + K v is what is
    left of the duty."""
    found = volts_of(s.view)
    if found is None or found[1] is None:
        return []
    volts, duty = found[0], found[1]
    supply = np.divide(volts, duty, out=np.zeros_like(volts), where=np.abs(duty) > 1e-9)

    def full(p: Array, duty: Array = duty) -> Array:
        return np.asarray(supply * np.clip(duty / max(float(p[0]), 1e-4), -1.0, 1.0))

    shape = s.shaped(full)
    return [
        Candidate(
            "pwm_deadband",
            "command",
            shape(np.array([knee])),
            (("u0", "1"),),
            sign=1,
            most=MOST,
            fixed={"knee": (knee, "1")},
            shape=shape,
            steps=(0.1 * knee,),
            searched=1,
        )
        for knee in KNEES
    ]


def lacks(s: Scene) -> str:
    """A duty."""
    return "" if "duty" in s.view.columns else "a column of the duty: measured volts have lost it already"


NAME = Name(
    "pwm_deadband",
    (VOLTS,),
    columns,
    (),
    "measure the volts at the motor's leads: brushes drop their volt behind them, a dead band before",
    lacks,
)
