"""A winding that its own loss heats: copper's resistance rises by 0.39 % per kelvin."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.electrical import COPPER
from calibration.channels.recursions import lowpass
from calibration.names.name import VOLTS, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

TAUS_S = (10.0, 20.0, 40.0, 80.0, 160.0, 320.0)  # small motors' windings; data sheets have 5 to 400 s
COOLED_S = 1e5  # between two files that each begin cold


def columns(s: Scene) -> list[Candidate]:
    """R alpha R i (i^2 low-passed): cold at the first row of the first file, or of every file."""
    clock = s.problem.t - s.problem.t.min()
    out = _heated(s, clock, "tau")
    if len(np.unique(s.problem.session)) > 1:
        out += _heated(s, clock + COOLED_S * s.problem.session, "tau_in_run")
    return out


def _heated(s: Scene, clock: Array, name: str) -> list[Candidate]:
    """By this clock, in whose pauses the winding cools; `name` is the time constant's."""
    i, clock = s.view.columns["current"], np.ascontiguousarray(clock)
    power = np.ascontiguousarray(s.at(i**2))
    volts = COPPER * s.declared["resistance"] ** 2 * s.at(i)

    def shape(p: Array) -> Array:
        return np.asarray(volts * lowpass(power, clock, max(float(p[0]), 1.0)))[:, None]

    span = float(s.problem.t.max() - s.problem.t.min())
    return [
        Candidate(
            "winding_heating",
            "time",
            shape(np.array([tau])),
            (("thermal_resistance", "K/W"),),
            sign=1,
            fixed={name: (tau, "s")},
            shape=shape,
            steps=(0.05 * tau,),
            searched=1,
        )
        for tau in TAUS_S
        if tau < 2 * span
    ]


NAME = Name(
    "winding_heating",
    (VOLTS,),
    columns,
    ("magnet_weakening",),
    "hold the rotor at a steady current for some minutes: R i rises with the winding, K v is not there",
)
