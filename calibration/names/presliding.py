"""Friction that builds up over a travel after every reversal."""

import numpy as np

from calibration.balances.friction import Path, sliding_of
from calibration.balances.recursions import stop_operator
from calibration.inputs.declaration import FrictionLaw
from calibration.names.name import Array, Candidate, Changed, Name, Scene, both_ways, tried
from calibration.names.scene import FEWEST

# part of the usual stroke: an element of half a stroke or more never slides, which is a spring. ASSUMPTION
RADII = (0.0005, 0.002, 0.005, 0.01, 0.02, 0.04, 0.08, 0.14, 0.2, 0.28, 0.36)
# times: sigma_0 is not published, only one beyond 1.7 with an estimate's scatter is a change. ASSUMPTION
UNPUBLISHED = 2.2
PRECISE = {"sigma_0": 0.2}  # standard error, of the number. ASSUMPTION


def columns(s: Scene) -> list[Candidate]:
    """One or two elastoplastic elements, or bristles that give way by and by (Dahl's law, LuGre without its
    dip), less the declared friction. This is the loop alone, sliding friction as it is. A positive size only:
    the other sign would feed energy."""
    if not s.both:
        return []
    v, stroke = s.view, s.stroke
    least, declared = v.resolved, sliding_of(v).shape
    path = Path(position=v.x, fresh=np.diff(v.file, prepend=-1) != 0, period_s=v.period_s)
    sizes = (("loop_force", s.unit), ("second_loop_force", s.unit))

    def element(radius: float) -> Array:
        return stop_operator(v.x, v.file, radius) / radius - declared

    def within(p: Array) -> float:
        return float(np.clip(p[0], max(least, 1e-6 * stroke), RADII[-1] * stroke))

    def one(p: Array) -> Array:
        return element(within(p))

    def two(p: Array) -> Array:
        return np.column_stack([one(p), one(np.maximum(p, 2 * least) / 2)])

    def bristles(p: Array) -> Array:
        return path.bristle(FrictionLaw(bristle_travel=within(p))) - declared

    shapes = ((one, 1, "breakaway_travel"), (two, 2, "breakaway_travel"), (bristles, 1, "bristle_travel"))
    return [
        tried(NAME.name, s.shaped(full), *sizes[:width], at={travel: (radius, s.angle_unit)}, sign=1)
        for radius in (part * stroke for part in RADII)
        if radius >= least and np.mean(np.abs(v.since) < 2 * radius) >= FEWEST
        for full, width, travel in shapes
    ]


NAME = Name(
    name="presliding",
    columns=columns,
    experiment="a sine smaller than break-away",
    lacks=both_ways,
    changed=Changed(numbers={"sigma_0": "stiffness_factor"}, factor=UNPUBLISHED, precise=PRECISE),
    loop=("breakaway_travel", "bristle_travel"),
)
