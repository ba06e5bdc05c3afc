"""Files that share the position's zero through a counter that wraps share it up to whole lengths only."""

from __future__ import annotations

import numpy as np

from calibration.inputs.declaration import Rig
from calibration.inputs.record import Record


def align_counters(records: list[Record], rig: Rig) -> None:
    """Move every file by whole lengths of its counter so that its middle is nearest to the first file's.

    Only where the rig file says that the zero is shared: otherwise every file has a zero of its own anyway.
    A drive that stays within half a counter's length of one place from file to file comes out right.
    """
    if rig.runs.get("origin") != "shared" or len(records) < 2:
        return
    for channel in ("position", "position2"):
        if channel not in rig.columns:
            continue
        length = _length(records, rig, channel)
        if not length:
            continue
        first = float(np.nanmedian(records[0].columns[channel]))
        for r in records[1:]:
            x = r.columns[channel]
            r.columns[channel] = x - length * np.round((float(np.nanmedian(x)) - first) / length)


def _length(records: list[Record], rig: Rig, channel: str) -> float:
    """Length of the channel's counter in rig units, declared or found; 0 for none."""
    declared = rig.columns[channel].wrap
    if declared:
        return abs(float(declared) * rig.columns[channel].scale)
    found = [x.size for r in records for x in r.repairs if x.kind == "wrap" and x.channel == channel]
    return float(np.median(found)) if found else 0.0
