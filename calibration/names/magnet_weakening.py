"""A torque constant that falls at some time, steeply or slowly: seen in the volts of a motor that turns."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate, ramp
from calibration.names.name import VOLTS, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

TRIALS, EDGE = 16, 0.05  # onsets that are tried, and what of the time is left out at either end
LENGTHS = (0.0, 0.4)  # of the time, that the fall may take at first


def columns(s: Scene) -> list[Candidate]:
    """Back-EMF lost from an onset over a ramp, by the clock that all files share or anew in every file."""
    v = s.view
    emf = -s.declared["torque_constant"] * v.rate(v.x)
    clocks = {"onset": v.clock - float(v.clock.min())}
    if len(np.unique(v.file)) > 1:
        clocks["onset_in_run"] = v.t
    out = []
    for where, clock in clocks.items():
        span = float(clock.max())

        def full(p: Array, clock: Array = clock) -> Array:
            return np.asarray(emf * ramp(clock, float(p[0]), float(p[1])))

        shape = s.shaped(full)
        for length in LENGTHS:
            for at in np.linspace(EDGE, 1 - EDGE, TRIALS) * span:
                if at + length * span > (1 - EDGE) * span:
                    continue
                out.append(
                    Candidate(
                        "magnet_weakening",
                        "time",
                        shape(np.array([at, length * span])),
                        (("fraction", "1"),),
                        sign=1,
                        most=1.0,
                        fixed={where: (float(at), "s"), "ramp": (length * span, "s")},
                        shape=shape,
                        steps=(0.02 * span, 0.02 * span),
                        searched=2,
                    )
                )
    return out


NAME = Name(
    "magnet_weakening",
    (VOLTS,),
    columns,
    ("winding_heating",),
    "turn the motor by hand or by another one at a known speed and read the volts of its open leads",
)
