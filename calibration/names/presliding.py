"""Friction that builds up over a travel after every reversal."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.friction import stop_operator
from calibration.channels.friction import bristle
from calibration.channels.frictionlaw import friction_shape
from calibration.names.name import FORCE, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array

# of the usual stroke; an element of half a stroke or more never slides, which is a spring
RADII = (0.0005, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.14, 0.2, 0.28, 0.36)
FEWEST = 0.005  # of the rows within twice the radius


def columns(s: Scene) -> list[Candidate]:
    """One or two elastoplastic elements, or bristles that give way by and by (Dahl's law, LuGre without its
    dip), less the declared friction: the loop alone, sliding friction as it is. A positive size only: the
    other sign would feed energy."""
    if not s.both:
        return []
    v = s.view
    stroke = float(np.quantile(np.abs(v.since[v.ok]), 0.95)) or 1.0
    least, declared = v.resolved, friction_shape(v)
    labels = (("loop_force", s.unit), ("second_loop_force", s.unit))

    def element(radius: float) -> Array:
        return stop_operator(v.x, v.file, radius) / radius - declared

    def one(p: Array) -> Array:
        return element(float(np.clip(p[0], max(least, 1e-6 * stroke), RADII[-1] * stroke)))

    def two(p: Array) -> Array:
        return np.column_stack([one(p), one(np.maximum(p, 2 * least) / 2)])

    fresh = np.concatenate([[True], np.diff(v.file) != 0])

    def bristles(p: Array) -> Array:
        travel = float(np.clip(p[0], max(least, 1e-6 * stroke), RADII[-1] * stroke))
        return bristle(v.x, fresh, v.period_s, 1.0, 1.0, 1.0 / travel) - declared

    out = []
    for part in RADII:
        radius = part * stroke
        if radius < least or np.mean(np.abs(v.since) < 2 * radius) < FEWEST:
            continue
        for full, width, travel in (
            (one, 1, "breakaway_travel"),
            (two, 2, "breakaway_travel"),
            (bristles, 1, "bristle_travel"),
        ):
            shape = s.shaped(full)
            out.append(
                Candidate(
                    "presliding",
                    "reversal",
                    shape(np.array([radius])),
                    labels[:width],
                    sign=1,
                    fixed={travel: (radius, s.angle_unit)},
                    shape=shape,
                    steps=(0.1 * radius,),
                    searched=1,
                )
            )
    return out


def lacks(s: Scene) -> str:
    """Reversals."""
    return "" if s.both else "reversals of the motion"


NAME = Name(
    "presliding", (FORCE,), columns, ("stribeck_change", "play"), "a sine smaller than break-away", lacks
)
