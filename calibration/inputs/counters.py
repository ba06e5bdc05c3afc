"""Counters that wrap: within a file they are unwrapped, between files they share their zero up to lengths."""

import numpy as np

from calibration.arrays import Array
from calibration.inputs.declaration import Rig
from calibration.inputs.run import Run


def unwrap(counts: Array, length: float) -> Array:
    """Unwrap a counter of `length` counts (n,); NaN stay NaN."""
    good = np.isfinite(counts)
    out = counts.copy()
    out[good] = np.unwrap(counts[good], period=length)
    return out


def count_wraps(counts: Array, unwrapped: Array, length: float) -> int:
    """How often the counter wrapped between two rows."""
    turns = np.round((unwrapped - counts) / length)
    return int(np.count_nonzero(np.diff(turns[np.isfinite(counts)])))


def align_counters(records: list[Run], rig: Rig) -> None:
    """Move every file by whole lengths of its counter so that its middle is nearest to the first file's.

    Only where the rig file says that the zero is shared: otherwise every file has a zero of its own anyway.
    A drive that stays within half a counter's length of one place from file to file comes out right.
    """
    if rig.runs.get("origin") != "shared" or len(records) < 2:
        return
    for channel in ("position", "position2"):
        length = _length(records, rig, channel) if channel in rig.columns else 0.0
        for r in records[1:] if length else ():
            x, first = r.columns[channel], float(np.nanmedian(records[0].columns[channel]))
            r.columns[channel] = x - length * np.round((float(np.nanmedian(x)) - first) / length)


def _length(records: list[Run], rig: Rig, channel: str) -> float:
    """Length of the channel's counter in rig units, declared or found; 0 for none."""
    declared = rig.columns[channel].wrap
    if declared:
        return abs(float(declared) * rig.columns[channel].scale)
    found = [x.size for r in records for x in r.repairs if x.kind == "wrap" and x.channel == channel]
    return float(np.median(found)) if found else 0.0
