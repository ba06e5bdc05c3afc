"""Shapes without a name that sums of names imitate: each is looked for alone, in the place of all names."""

from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.finding import UNKNOWN
from calibration.names.name import Candidate, Scene, tried
from calibration.names.scene import FEWEST
from calibration.names.unknown_shapes import over

SETTLED = 5  # fits of the declared terms beside a force's own square, until both hold still. ASSUMPTION
# part of the range, where an end stop may begin, from the other end. ASSUMPTION: a margin of a stroke
BEGINS = (0.5, 0.6, 0.7, 0.8, 0.9)
PLACE_STEP = 0.01  # part of the range, a small change of that place. ASSUMPTION
# places of a dent that are tried, of the range: two of the least widths apart. ASSUMPTION
PLACES = tuple((k + 0.5) / 25 for k in range(25))
WIDTHS = (0.02, 0.05)  # of the range: widths of a dent that are tried, standard deviations. ASSUMPTION
REACH = 8.0  # widths from its place at which a dent is no more than rounding. arithmetic
NARROWEST = 1e-3  # of the range, that a dent is at least wide. ASSUMPTION
WIDTH_STEP = 0.1  # of a dent's width, a small change of it. ASSUMPTION


def alone(s: Scene) -> list[Candidate]:
    """The shapes of this balance: a dent between two sensors, an end stop or a bent torque in a force.

    None stands beside an offset that wanders, or is every file's own. An end stop would then be any slope.
    """
    r = s.view.response
    if s.pair is not None or s.view.slow_offset is not None or r.is_speed or not s.view.ok.any():
        return []
    if not s.force:
        return _dents(s)
    if not s.view.dynamic or r.channel == "acceleration":
        return []
    iron = _saturation(s) if r.channel in ("effort", "current") else []
    return [*iron, *_end_stops(s)]


def _saturation(s: Scene) -> list[Candidate]:
    """Torque that falls behind its effort, as iron saturates: the square of the force that the declared terms
    make beside it."""
    force = s.declared_part
    for _ in range(SETTLED):
        bent = force * np.abs(force) / (float(np.max(np.abs(force))) or 1.0)
        force = s.fitted(bent[:, None])[1]
    return [over("current", bent, ("square", s.unit))]


def _end_stops(s: Scene) -> list[Candidate]:
    """A buffer of rubber at one end of the stroke: stiffer the further it is pressed, no force before."""
    low, span = _range(s)
    out = []
    for side, end in ((1.0, low), (-1.0, low + span)):

        def full(p: Array, side: float = side) -> Array:
            return np.asarray(side * np.maximum(side * (s.view.x - p[0]), 0.0) ** 2 / span**2)

        for part in BEGINS:
            at = {"begin": (end + side * part * span, s.angle_unit)}
            more: dict[str, Any] = {"domain": "axis_angle", "positive": (0,), "steps": (PLACE_STEP * span,)}
            out.append(tried(UNKNOWN, s.shaped(full), ("square", s.unit), at=at, **more))
    return out


def _dents(s: Scene) -> list[Candidate]:
    """A dent in a tape or a rack, dirt on a disc: one place of the travel."""
    low, span = _range(s)

    def full(p: Array) -> Array:
        off = np.abs(s.view.x - p[0]) / max(abs(p[1]), NARROWEST * span)
        return np.where(off < REACH, np.exp(-0.5 * off**2), 0.0)

    out = []
    for width in WIDTHS:
        steps = (PLACE_STEP * span, WIDTH_STEP * width * span)
        for place in PLACES:
            if np.mean(np.abs(s.view.x - low - place * span) < width * span) < FEWEST:
                continue
            at = {"place": (low + place * span, s.angle_unit), "width": (width * span, s.angle_unit)}
            size = ("amplitude", s.unit)
            out.append(tried(UNKNOWN, s.shaped(full), size, at=at, steps=steps, domain="axis_angle"))
    return out


def _range(s: Scene) -> tuple[float, float]:
    """Where the position's range begins, and its length, position units."""
    x = s.view.x[s.view.ok]
    return float(np.min(x)), float(np.ptp(x)) or 1.0
