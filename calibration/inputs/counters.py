"""Counters: within a file they are unwrapped, between files they share their zero up to lengths.

Numbers of both signs that a logger wrote as unsigned words (65535 is -1) are told by the values of all runs.
"""

import numpy as np

from calibration.arrays import Array
from calibration.inputs import thresholds as limits
from calibration.inputs.declaration import Rig
from calibration.inputs.repair import MOVING, SLOW, signed_note
from calibration.inputs.run import Repair, Run, signal_of

# values of a logger's word of 16, 24 or 32 bits. definition; shorter ones are counts and duties as they are
LENGTHS = (2.0**16, 2.0**24, 2.0**32)


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
        if not length:
            continue
        first = float(np.nanmedian(records[0].columns[channel]))
        for r in records[1:]:
            x = r.columns[channel]
            r.columns[channel] = x - length * np.round((float(np.nanmedian(x)) - first) / length)


def _length(records: list[Run], rig: Rig, channel: str) -> float:
    """Length of the channel's counter in rig units, declared or found; 0 for none."""
    declared = rig.columns[channel].wrap
    if declared:
        return abs(float(declared) * rig.columns[channel].scale)
    found = [x.size for r in records for x in r.repairs if x.kind == "wrap" and x.channel == channel]
    return float(np.median(found)) if found else 0.0


def read_signed(runs: list[Run], rig: Rig) -> None:
    """Read such columns with their sign, in place and in every run alike; `run.repairs` says so."""
    for channel, where in rig.columns.items():
        signed = where.wrap is not None or where.sign_bit is not None
        made = signed or where.steps or where.integrated or where.files
        if channel in ("time", *MOVING, *SLOW) or made:
            continue
        words = [(r.columns[channel] - where.offset) / where.scale for r in runs]
        length = word_length(np.concatenate(words))
        for r, x in zip(runs, words, strict=True):
            if count := int(np.count_nonzero(x > length / 2)) if length else 0:
                r.columns[channel] = np.where(x > length / 2, x - length, x) * where.scale + where.offset
                name = str(where.column) or channel
                r.signals[channel] = signal_of(channel, name, where.unit, r.columns[channel], 0)
                note = signed_note(length)
                r.repairs.append(Repair("signed", channel, count, length * abs(where.scale), note))


def word_length(x: Array) -> float:
    """Values that the word of `x` (n,) has, 0 where it is no such word.

    Numbers of either sign fill the two ends of the word, and the middle quarter of it stays empty.
    """
    x = x[np.isfinite(x)]
    whole = np.round(x)
    near = limits.WHOLE_COUNT
    if len(x) < limits.FEWEST_SAMPLES or not np.allclose(x, whole, rtol=near, atol=near):
        return 0.0
    length = next((w for w in LENGTHS if whole.max() < w), 0.0)
    lower, upper = whole[whole < length * 3 / 8], whole[whole >= length * 5 / 8]
    # one value at the end of a word is a reading that failed
    several = len(np.unique(upper)) >= limits.FEWEST_SIGNED
    if whole.min() < 0 or not several or len(lower) + len(upper) < len(whole):
        return 0.0
    beyond = length - upper.max() + (lower.min() if len(lower) else 0.0)  # about zero, from either side
    empty = upper.min() - (lower.max() if len(lower) else 0.0)
    return length if beyond < limits.ABOUT_ZERO * empty else 0.0
