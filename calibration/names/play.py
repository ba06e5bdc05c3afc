"""A gap that a reversal must cross before the other side follows."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.balances.recursions import stop_operator
from calibration.balances.view import acceleration
from calibration.names.name import Array, Candidate, Made, Name, Scene, both_ways, candidate, grid, value
from calibration.names.presliding import NAME as BRISTLES
from calibration.names.scene import FEWEST, FORCE, SENSORS
from calibration.names.shaft_compliance import NAME as WIND_UP
from plant.units import ARCSEC

# of the usual stroke: gaps that are tried in a balance of forces. ASSUMPTION
PARTS = (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1)
# -log10 p between two sensors of a rig: a dozen gaps are tried, not a thousand orders (decide/accept.py);
# set on the geared servo's output encoder. ASSUMPTION beyond it
LEAST = 6.0
SIDES = 0.1  # share of the usual acceleration: below, the driven side is between the flanks. ASSUMPTION
GROWS = 1.5  # times, from one gap that is tried between two sensors to the next. ASSUMPTION
WIDEST = 0.2  # of the travel, that a gap between them is below. ASSUMPTION
# gaps that are tried of an axis' encoder. ASSUMPTION
GAPS_ARCSEC = (0.6, 1.2, 2.5, 5.0, 10.0, 20.0, 40.0, 80.0)
SMALLEST_ARCSEC = 0.1  # the smallest of them. ASSUMPTION
REACH = 0.5  # of the travel, that an axis' gap is below. ASSUMPTION
STEP = 0.15  # of a gap, for its refinement. ASSUMPTION
TRAVEL = "travel"  # how far one side moves before the other follows: the gap once more, by its place


def columns(s: Scene) -> list[Candidate]:
    """Between two sensors the place in the gap; of forces, friction that a gap, being crossed, lacks."""
    if not s.both:
        return []
    if s.pair is not None:
        return [] if s.force else _of_the_coupling(s)
    return _missing_force(s) if s.force else [*_between_sensors(s), *_thrown(s)]


def _missing_force(s: Scene) -> list[Candidate]:
    v = s.view
    if v.response.channel == "acceleration":
        return []  # nothing drives through a gap
    least, gaps = v.resolved, [part * s.stroke for part in PARTS]
    seen = [gap for gap in gaps if gap >= least and np.mean(np.abs(v.since) < gap) >= FEWEST]

    def full(p: Array) -> Array:
        return np.asarray(-v.direction * (np.abs(v.since) < max(float(p[0]), least)))

    # a gap in the force's way is the rarer one of the two
    more: dict[str, Any] = {"step": STEP, "sign": 1, "searched": 4, "twins": (BRISTLES.name,)}
    size, along = ("missing_force", s.unit), ("gap", seen, s.angle_unit)
    return grid(NAME.name, s.shaped(full), size, along=along, **more)


def _between_sensors(s: Scene) -> list[Candidate]:
    """The second sensor lags; of a difference of unknown order (ratio 0) either one may be it."""
    v, span = s.view, s.span
    first = max(float(np.median(np.abs(s.residual))) / 8, 1e-6 * span, 1e-12)
    count = max(int(np.ceil(np.log(max(WIDEST * span / first, 1.0)) / np.log(GROWS))), 0)

    step = np.diff(v.x, prepend=v.x[0])
    step[np.diff(v.file, prepend=v.file[0]) != 0] = 0.0
    moved = np.cumsum(step)  # a file begins where in the gap the last one has ended, for want of better

    def full(p: Array) -> Array:
        gap = max(float(p[0]), 1e-9 * span)
        return lag_in_gap(moved, np.zeros_like(v.file), gap) / gap

    along = (TRAVEL, first * GROWS ** np.arange(count), s.angle_unit)
    return grid(NAME.name, s.shaped(full), ("gap", s.unit), along=along, step=STEP, **_sided(s))


def _thrown(s: Scene) -> list[Candidate]:
    """A driven side with little friction is thrown from flank to flank: it leads while the drive brakes."""
    a = acceleration(s.view)
    usual = float(np.sqrt(np.mean(a[s.view.ok] ** 2)))
    if usual == 0:
        return []
    side = s.at(-np.tanh(a / (SIDES * usual)) / 2)
    return [candidate(NAME.name, side, ("gap", s.unit), searched=1, twins=(WIND_UP.name,), **_sided(s))]


def _sided(s: Scene) -> dict[str, Any]:
    return {"sign": 0 if s.view.response.ratio == 0 else 1, "least": LEAST}


def _of_the_coupling(s: Scene) -> list[Candidate]:
    """A gap in the coupling of an axis' absolute encoder: its reading stands while the axis crosses it."""
    assert s.pair is not None
    p, rows = s.problem, s.pair.motion.rows
    # arcsec, where the axis is by both motors, less the wind-up that the base takes up
    apart = p.y - p.base[:, p.place("compliance")] * s.declared["compliance"]
    moved = s.view.x[rows] / ARCSEC + apart.reshape(2, -1).mean(axis=0)

    def shape(p: Array) -> Array:
        gap = max(float(p[0]), SMALLEST_ARCSEC)
        one = lag_in_gap(moved, s.view.run[rows], gap) / gap
        return np.concatenate([-one, -one])[:, None]

    along = (TRAVEL, [gap for gap in GAPS_ARCSEC if gap < REACH * float(np.ptp(moved))], "arcsec")
    return grid(NAME.name, shape, "gap", along=along, searched=0, sign=1, stage="axis")


def lag_in_gap(moved: Array, run: NDArray[np.int64], gap: float) -> Array:
    """Reading less place, unit of `gap`, of a sensor behind one; a run starts in the middle of the gap."""
    return -stop_operator(moved, run, 0.5 * gap)


def travel_of(c: Candidate) -> float | None:
    """Of a gap between two sensors: how far one moves until the other follows, position units."""
    return abs(c.fixed[TRAVEL][0]) if c.name == NAME.name and TRAVEL in c.fixed else None


NAME = Name(
    name="play",
    channels=(SENSORS, FORCE),
    columns=columns,
    experiment="a slow reversal under load, or lock the output and step the torque: play is a step, "
    "compliance a line",
    lacks=both_ways,
    # the motors are compared with the absolute encoder, so its coupling has the gap
    to_plant=lambda f, facts: Made().added(f, facts, gap=value(f, "gap"), encoder=value(f, "encoder", 1.0)),
    loop=("gap",),
)
