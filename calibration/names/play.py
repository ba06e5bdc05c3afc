"""A gap that a reversal must cross before the other side follows."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.view import acceleration
from calibration.names.name import FORCE, SENSORS, Name
from calibration.names.scene import Scene
from calibration.readers.run import Array
from plant.effects.signals import RATE, TIME

PARTS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)  # gaps that are tried, of the travel
# -log10 p between two sensors: a dozen gaps are tried, not a thousand orders (decide/accept.py);
# set on the geared servo's output encoder
LEAST = 6.0
SIDES = 0.1  # of the usual acceleration: below, the driven side is between the flanks. ASSUMPTION
GROWS = 1.5  # from one gap to the next, between two sensors


def gap_angle(s: Scene, gap: float) -> Array:
    """Where the driven side is in the gap, -1 .. 1 at full rate: the effect's own formula, whose gap is in
    arcsec at the axis."""
    v = s.view
    unit = np.pi / 648000.0  # rad per arcsec
    step = np.asarray(np.diff(v.x, prepend=v.x[0]), dtype=np.float64)
    step[np.concatenate([[True], np.diff(v.file) != 0])] = 0.0
    rate = step / v.period_s / gap * unit  # in gaps of one arcsec per s
    time = np.asarray(np.arange(len(v.t)) * v.period_s, dtype=np.float64)
    e = s.formula("play", {TIME: time, RATE: rate}, {"gap": unit, "encoder": 2.0})
    return np.asarray(e / (0.5 * unit))


def columns(s: Scene) -> list[Candidate]:
    """Between two sensors: the place in the gap. In a balance of forces: friction that is missing while the
    gap is crossed."""
    if not s.both:
        return []
    if not s.force:
        return _between_sensors(s)
    v = s.view
    if v.response.channel == "acceleration":
        return []  # nothing drives through a gap
    stroke = float(np.quantile(np.abs(v.since[v.ok]), 0.95)) or 1.0
    least = v.resolved
    out = []
    for part in PARTS:
        gap = part * stroke
        if gap < least or np.mean(np.abs(v.since) < gap) < 0.005:
            continue

        def full(p: Array) -> Array:
            return np.asarray(-v.direction * (np.abs(v.since) < max(float(p[0]), least)))

        shape = s.shaped(full)
        out.append(
            Candidate(
                "play",
                "reversal",
                shape(np.array([gap])),
                (("missing_force", s.unit),),
                sign=1,
                fixed={"gap": (gap, s.angle_unit)},
                shape=shape,
                steps=(0.15 * gap,),
                searched=4,  # a gap in the force's way is the rarer one of the two
                twins=("presliding",),
            )
        )
    return out


def _between_sensors(s: Scene) -> list[Candidate]:
    reach = 0.2 * s.span
    gap = max(float(np.median(np.abs(s.residual))) / 8, 1e-6 * s.span, 1e-12)
    out = []
    while gap < reach:

        def full(p: Array) -> Array:
            return gap_angle(s, max(float(p[0]), 1e-9 * s.span)) / 2

        shape = s.shaped(full)
        out.append(
            Candidate(
                "play",
                "reversal",
                shape(np.array([gap])),
                (("gap", s.unit),),
                # the second sensor lags; of a difference of unknown order (ratio 0) either one may be it
                sign=0 if s.view.response.ratio == 0 else 1,
                least=LEAST,
                fixed={"closing_travel": (gap, s.angle_unit)},
                shape=shape,
                steps=(0.15 * gap,),
                searched=1,
            )
        )
        gap *= GROWS
    return [*out, *_thrown(s)]


def _thrown(s: Scene) -> list[Candidate]:
    """A driven side with little friction of its own is thrown from flank to flank by the accelerations: it
    leads while the drive brakes."""
    a = acceleration(s.view)
    usual = float(np.sqrt(np.mean(a[s.view.ok] ** 2))) if s.view.ok.any() else 0.0
    if usual == 0:
        return []
    return [
        Candidate(
            "play",
            "reversal",
            s.at(-np.tanh(a / (SIDES * usual)) / 2)[:, None],
            (("gap", s.unit),),
            sign=0 if s.view.response.ratio == 0 else 1,
            least=LEAST,
            searched=1,
            twins=("shaft_compliance",),
        )
    ]


def lacks(s: Scene) -> str:
    """Reversals."""
    return "" if s.both else "reversals of the motion"


NAME = Name(
    "play",
    (SENSORS, FORCE),
    columns,
    ("shaft_compliance", "presliding"),
    "a slow reversal under load; lock the output and step the torque: play is a step, compliance a line",
    lacks,
)
