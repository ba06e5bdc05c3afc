"""A short pulse once per turn of one part: a damaged tooth."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.tooth import folded, pulse
from calibration.inputs.declaration import Stage
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

ENOUGH = 0.9  # turns of the part, as on an axis
SWEPT = 0.12  # of a turn per fitted row: quicker, a tooth is not seen
KEEP = 3
LEAST = 20.0  # -log10 p: a place and a width are searched for on every part
MOTORS = ("motor", "motor_cogging", "torque_ripple")


def columns(s: Scene) -> list[Candidate]:
    """The best few pulses on every declared part that turns about once in the log."""
    return [c for g in s.view.rig.stages if g.period for c in _on(s, g, 1.0 / g.period)]


def _on(s: Scene, stage: Stage, rate: float) -> list[Candidate]:
    """On one part, of `rate` turns per position unit."""
    v, p = s.view, s.problem
    if s.span * rate < ENOUGH:
        return []
    phase = v.x * rate
    row = np.abs(v.speed) * rate * v.period_s  # turns that a full-rate row sweeps
    ok = p.train & (row[v.rows] * max(v.step, v.sigma) < SWEPT)

    def full(q: Array) -> Array:  # what the response has beside it is minus what acts on the axis
        return -pulse(phase, float(q[0]), max(float(q[1]), 0.002), row)

    shape = s.shaped(full)
    return [
        Candidate(
            "damaged_tooth",
            "motor_angle" if stage.kind in MOTORS else "axis_angle",
            shape(np.array([centre, width])),
            (("amplitude", s.unit),),
            stage=stage.name,
            order=rate * (v.turn or 1.0),
            fixed={"phase": (centre, "turn"), "width": (width, "turn")},
            shape=shape,
            steps=(0.003, 0.1 * width),
            least=LEAST,
            searched=2,
        )
        for centre, width in folded(phase[v.rows][ok], s.residual[ok], KEEP)
    ]


def lacks(s: Scene) -> str:
    """A part, and a turn of it."""
    turns = [s.span / g.period for g in s.view.rig.stages if g.period]
    return "" if turns and max(turns) >= ENOUGH else "a declared stage with its period, and a turn of it"


NAME = Name(
    "damaged_tooth",
    (FORCE,),
    columns,
    ("gear_eccentricity",),
    "turn the part slowly, both ways: a tooth is a pulse at one place, an eccentric part a sine",
    lacks,
)
