"""A run driven again beside its log: behind every transient the axis comes to stand at the log's angle.

Another controller in the log leaves the simulated axis at another angle, where periodic torques have another
phase. The set point of the transient takes that offset out; the offset is a figure of its own.
"""

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.filters import pieces
from calibration.replay import thresholds as limits
from calibration.replay.trace import Loop, Trace
from plant.model import PlantModel


def drive(loop: Loop, model: PlantModel, rows: Mask, use: Mask) -> tuple[Trace, Array]:
    """Run `model` along the run `rows` (mask of the log's rows), of whose rows `use` are compared; with how
    far each of its transients, run as it is, moves the axis against the log, arcsec. Raises ValueError where
    the plant cannot be run."""
    period_s, position = loop.frame.period_s, loop.measured(rows).position
    half = round(limits.SETTLE_S / period_s / 2)
    least = max(limits.LEAST_ROWS, half)
    settled = use & np.isfinite(position)
    parts = [first for first, end in pieces(settled.astype(int)) if settled[first] and end - first >= least]
    nudge = np.zeros(len(position))  # arcsec/s beside the set point, in the first half of what settles
    found: list[tuple[float, Trace, Array]] = []
    for _ in range(1 + limits.NUDGES):
        trace = loop.again(model, rows, nudge)
        beside = trace.position - position
        offsets = np.array([np.mean(beside[first : first + half]) for first in parts])
        found.append((float(np.abs(offsets).max(initial=0.0)), trace, np.diff(offsets, prepend=0.0)))
        for first, moved in zip(parts, found[-1][2], strict=True):
            start = max(first - 2 * half, 0)
            nudge[start : start + half] -= moved / (half * period_s)
    _, best, _ = min(found, key=lambda one: one[0])
    return best, found[0][2]
