"""The search for lines over the position at orders that no stage has."""

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.names.lines import OWN, cell, movable, peaks_over_place, seen
from calibration.names.scene import Scene
from calibration.statistics.orders import order_spectrum, peaks

# lines that are tried of a drive with one motor. ASSUMPTION
MOST = 6
# harmonics of an axis' stage at least, at which no line is free. ASSUMPTION
HARMONICS = 3
# cycles per turn that are searched on an axis whose position is absolute. ASSUMPTION
TOP = 3000.0
# lines that are tried there. ASSUMPTION
FREE = 4
# share of 1 / travel that lies between them at least. ASSUMPTION
APART = 1.5
# parts of such a cell, places about each line: it is refined from the best. ASSUMPTION
SHIFTS = (-0.2, 0.0, 0.2)


def free_lines(s: Scene) -> list[Candidate]:
    """Lines over position at no stage's period that stand out of the residual; of a pair the strongest."""
    least = HARMONICS if s.pair is not None else 0
    turning = [(g.period, g.listed or range(1, max(g.harmonics, least) + 1)) for g in s.view.rig.stages]
    taken = np.array([h / period for period, orders in turning if period for h in orders])
    if s.span <= 0:
        return []
    if s.pair is not None:
        found = strongest(s, np.ones(len(s.problem.y)), taken)
    else:
        peaked = peaks_over_place(s, MOST)
        found = [f for f in peaked if np.all(np.abs(f - taken) * s.span >= OWN) and seen(s, f)]
    return [c for rate in found for c in movable(s, rate, between(rate, taken, s.span))]


def strongest(s: Scene, weight: Array, taken: Array | None = None) -> list[float]:
    """Rates (1/position unit) about a pair's strongest lines times `weight` (n_fitted,), off the `taken`."""
    rows, turns, cells = s.problem.train, s.view.x[s.view.rows] / s.turn, s.turn / s.span
    e = np.where(rows, s.residual, 0.0)
    orders, power = order_spectrum(e, turns, np.where(rows, weight, 0.0), TOP)
    if taken is not None and len(orders):
        near = np.min(np.abs(orders[:, None] - taken[None, :] * s.turn), axis=1) < OWN * cells
        power = np.where(near, 0.0, power)
    found = peaks(orders, power, FREE, APART * cells)
    return [float(order) / s.turn + shift / s.span for order in found for shift in SHIFTS]


def between(rate: float, known: Array, span: float) -> tuple[float, float]:
    """How far a rate may be moved: within its resolution cell, and not to where a stage's begins."""
    low, high = cell(rate, span)
    for stage in known[np.abs(known - rate) < 1.0 / span]:
        if stage >= rate:
            high = min(high, float(stage) - OWN / span)
        else:
            low = max(low, float(stage) + OWN / span)
    return low, max(low, high)
