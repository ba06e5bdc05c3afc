"""A bit of the absolute encoder's word that never changes: no effect of the catalogue, and no motion."""

import numpy as np

from calibration.arrays import Array
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.run import Run
from plant.units import ARCSEC


def repair_stuck_bit(run: Run) -> Finding | None:
    """The finding where one bit of the position's counts stays what it is between others that change. In
    place, the bit is put back by the motion.

    A range of four of the bit's steps holds both of its values, whatever the motion. Bits below the lowest
    one that changes are the encoder's resolution.
    """
    counts = run.raw.get("position")
    if counts is None or "velocity" not in run.columns:  # a table's runs have no counts
        return None
    good = np.isfinite(counts)
    words = counts[good].astype(np.int64)
    if len(words) < 2:
        return None
    changes = np.bitwise_or.reduce(words ^ words[0])
    # a stuck bit hides itself, not the range: the bits above it count on
    top = int(np.ptp(words)).bit_length() - 2
    stuck = [b for b in range(top) if not changes >> b & 1 and changes & ((1 << b) - 1)]
    if len(stuck) != 1:
        return None
    (bit,) = stuck
    step, at_one = float(1 << bit), bool(words[0] >> bit & 1)
    missing = np.zeros(len(counts))
    scale = run.scales["position_arcsec_per_count"]
    rate = np.nan_to_num(run.columns["velocity"][good]) / (scale * ARCSEC)
    moved = (rate[1:] + rate[:-1]) / 2 * np.diff(run.columns["t"][good])
    missing[good] = _hidden(counts[good], moved, -step if at_one else step)
    run.columns["position"] = run.columns["position"] + missing * scale * ARCSEC
    rows = int(np.count_nonzero(missing))
    note = f"{run.name}: bit {bit} of the position is always {int(at_one)}; {rows} rows are put right"
    told = {"bit": Parameter(float(bit), "1"), "step": Parameter(step * scale, "arcsec")}
    # the chance that a bit which half of the range holds at either value is seen at one in all stretches
    evidence = float(np.log10(2.0) * np.count_nonzero(np.diff(missing)))
    return Finding(UNKNOWN, "S", "axis_angle", parameters=told, evidence=evidence, share=1.0, note=note)


def _hidden(x: Array, moved: Array, step: float) -> Array:
    """Counts that each row (n,) of x lacks, 0 or `step`, where the roller has `moved` (n - 1,) counts from
    row to row. It is the path of the smallest distance from it (Viterbi's, of two states)."""
    states = np.array([0.0, step])
    cost, came = np.zeros(2), np.zeros((len(x), 2), dtype=int)
    for k, off in enumerate(np.diff(x) - moved, start=1):
        paths = cost[:, None] + np.abs(off + states[None, :] - states[:, None])
        came[k] = paths.argmin(axis=0)
        cost = paths.min(axis=0)
    lacks = np.zeros(len(x), dtype=int)
    lacks[-1] = cost.argmin()
    for k in range(len(x) - 1, 0, -1):
        lacks[k - 1] = came[k, lacks[k]]
    return states[lacks]
