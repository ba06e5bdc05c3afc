"""What is wrong with columns before any physics: counters that wrap, spikes, samples that repeat, readings at
the end of their range."""

import numpy as np

from calibration.arrays import Array, Mask, by_median
from calibration.inputs import thresholds as limits
from calibration.inputs.declaration import Column, Rig
from calibration.inputs.rows import lost_rows, repeated_rows, rows_without_a_stamp
from calibration.inputs.run import Repair, Run
from plant.units import ARCSEC_PER_TURN

WORDS = tuple(2.0**k for k in range(8, 33))
CIRCLES = (1.0, 24.0, 360.0, 2 * np.pi, 86400.0, ARCSEC_PER_TURN, 400.0, 1000.0)
MOVING = ("position", "position2", "velocity", "reference")
SLOW = ("supply", "temperature", "normal")  # what leaps there may be real


def repair(run: Run, rig: Rig) -> None:
    """Repair the run's columns in place; what was done is in `run.repairs`."""
    for channel, where in rig.columns.items():
        if channel == "time":
            continue
        if where.wrap is None and channel not in SLOW:
            _wraps(run, channel, where)
        if channel == "position":
            _leaps(run, channel)
        if channel not in SLOW:
            _spikes(run, channel)
        if channel in ("effort", "current", "force"):
            _saturation(run, channel)
    repeated_rows(run, rig)
    lost_rows(run)
    if not rig.columns["position"].integrated:  # the sum of a speed does not know of rows that are gone
        rows_without_a_stamp(run)


def _wraps(run: Run, channel: str, where: Column) -> None:
    """Undo jumps by the whole length of a counter that nobody declared."""
    raw = (run.columns[channel] - where.offset) / where.scale
    good = np.flatnonzero(np.isfinite(raw))
    x = raw[good]
    length = counter_length(x) if len(x) >= limits.FEWEST_SAMPLES else 0.0
    if not length:
        return
    joined = np.unwrap(x, period=length)
    turns = np.round((joined - x) / length)
    stretches = np.diff(np.flatnonzero(np.concatenate([[True], np.diff(turns) != 0, [True]])))[1:-1]
    # there and back in a row or two is a spike, not a wrap
    spike = len(stretches) > 0 and np.max(stretches) <= 2 and stretches.sum() < 0.01 * len(x)
    if spike or np.abs(np.diff(joined)).max() > 0.5 * float(x.max() - x.min()):
        return
    kind, note = "wrap", f"a counter of {length:g} wraps: joined"
    if np.allclose(x, np.round(x)) and channel not in MOVING and np.ptp(turns) == 1:
        joined = np.where(x > length / 2, x - length, x)
        kind, note = "signed", signed_note(length)
    raw[good] = joined
    run.columns[channel] = raw * where.scale + where.offset
    count = int(np.count_nonzero(np.diff(turns)))
    run.repairs.append(Repair(kind, channel, count, length * abs(where.scale), note))


def signed_note(length: float) -> str:
    """How a report tells of words of `length` values that are read with a sign."""
    return f"signed numbers of {length:g} values written unsigned: {length - 1:g} is -1"


def counter_length(x: Array) -> float:
    """Length of the counter that `x` (n,) jumps by, in its unit; 0 for none."""
    span = float(x.max() - x.min())
    step = np.diff(x)
    usual = float(np.quantile(np.abs(step), 0.75))  # quick motion may wrap in every tenth row
    jumps = np.abs(step) > max(0.5 * span, 4 * usual)
    if span <= 0 or not jumps.any() or jumps.mean() > limits.MOST_JUMPS:
        return 0.0
    if len(np.unique(x)) < limits.FEWEST_LEVELS:  # a switch
        return 0.0
    size = float(np.median(np.abs(step[jumps])))
    lengths = (*WORDS, 360.0) if np.allclose(x, np.round(x)) else CIRCLES
    length = min((w for w in lengths if w >= span * 0.999), key=lambda w: abs(w - size), default=0.0)
    near = abs(length - size) <= limits.NEAR_LENGTH * length
    # a register's word begins at zero or is signed; what goes beyond it moved so far
    inside = length not in WORDS or (x.min() >= 0 and x.max() < length) or np.abs(x).max() <= length / 2
    return length if length and near and inside and _is_counter(x, step, jumps, length) else 0.0


def _is_counter(x: Array, step: Array, jumps: Mask, length: float) -> bool:
    """Whether jumps are a counter's and not the column's own. A counter jumps by its length less what moves
    in a row. Or the column uses it from end to end, and then a real step may fall on a wrap."""
    still = step[~jumps]
    moved = limits.MOVED_TIMES * float(np.quantile(np.abs(still), 0.99)) + 2.0 * _least_step(still)
    near = np.abs(np.abs(step[jumps]) - length) <= min(moved, limits.NEAR_LENGTH * length)
    whole = length in WORDS and np.ptp(x) >= length - 1 - moved
    return bool(np.mean(near) >= limits.MOST_JUMPS_WHOLE or whole)


def _least_step(step: Array) -> float:
    return float(np.min(np.abs(step[step != 0]), initial=np.inf)) if np.any(step != 0) else 0.0


def _leaps(run: Run, channel: str) -> None:
    """Join a position that leaps by a constant while the motion goes on: a counter that lost its zero."""
    step = np.diff(run.columns[channel])
    size = np.abs(step[np.isfinite(step)])
    if len(size) < limits.FEWEST_ROWS or np.any(np.diff(run.columns["t"]) > run.gap_s):
        return
    usual = limits.LEAP_TIMES * float(np.quantile(size, 0.995))
    at = np.flatnonzero(np.abs(np.nan_to_num(step)) > max(usual, 20 * _least_step(step)))
    close = len(at) > 1 and np.diff(at).min() <= limits.LEAP_ROWS
    if not 0 < len(at) <= limits.MOST_LEAPS or close or usual == 0:
        return
    run.columns[channel] = run.columns[channel].copy()
    for k in at:
        around = np.concatenate([step[max(k - 3, 0) : k], step[k + 1 : k + 4]])
        excess = float(step[k] - np.nanmedian(around))
        run.columns[channel][k + 1 :] -= excess
        note = f"leaps by {excess:.4g} between rows {k + 1} and {k + 2}: joined"
        run.repairs.append(Repair("leap", channel, 1, excess, note))


def _spikes(run: Run, channel: str) -> None:
    """Leave out rows far off the line through their neighbours, which agree with each other."""
    x = run.columns[channel]
    if len(x) < limits.FEWEST_SAMPLES:
        return
    gap = np.concatenate([[False], np.diff(run.columns["t"]) > run.gap_s])
    bad = (_far_off(x, 1) | _far_off(x, 2)) & ~(gap | np.roll(gap, -1))  # single rows, and pairs
    if not 0 < bad.sum() <= max(3, limits.MOST_SPIKES * len(x)):
        return
    rows = ", ".join(str(k + 1) for k in np.flatnonzero(bad)[: limits.TOLD_ROWS])
    more = " …" if bad.sum() > limits.TOLD_ROWS else ""
    size = float(np.nanmax(np.abs(x[bad] - np.nanmedian(x))))
    note = f"rows {rows}{more} are far off their neighbours: left out"
    run.repairs.append(Repair("spike", channel, int(bad.sum()), size, note))
    run.columns[channel] = np.where(bad, np.nan, x)


def _far_off(x: Array, width: int) -> Mask:
    """Rows of `x` (n,) in pieces of `width` rows that stand alone."""
    before, after = np.roll(x, width), np.roll(x, -width)
    off = np.abs(x - (before + after) / 2)
    off[:width], off[-width:] = 0.0, 0.0
    wide = np.roll(x, width + 1) + np.roll(x, -width - 1)
    calm, near = np.abs((before + after) / 2 - wide / 2), np.abs(after - before)
    finite = np.isfinite(off)
    if finite.sum() < limits.FEWEST_SAMPLES:
        return np.zeros(len(x), dtype=bool)
    noise = max(by_median(off), float(np.nanquantile(off, 0.95)) / 2)
    found = finite & (off > limits.SPIKE * noise) & (off > 4 * np.maximum(near, calm)) & (noise > 0)
    return np.asarray(found & (off > _clear_of_tails(np.nan_to_num(off))))


def _clear_of_tails(off: Array) -> float:
    """Size from which on values are a group of their own: heavy tails thin out, spikes leave a gap."""
    top = off.copy()
    for shift in (-2, -1, 1, 2):  # a spike moves its neighbours' lines, too
        top[off < np.roll(off, shift)] = 0.0
    most = max(int(limits.MOST_SPIKES * len(off)), 3)
    largest = np.sort(top)[::-1][: most + 1 + limits.TAIL]
    limit = float("inf")
    for k in range(1, min(most + 1, len(largest) - limits.TAIL)):
        rest = largest[k : k + limits.TAIL + 1]
        if rest[0] <= 0 or rest[-1] <= 0:
            return float(rest[0])
        leap = largest[k - 1] / rest[0]
        tail = float(np.mean(np.log(rest[:-1] / rest[-1])))  # Hill's estimate of 1 / the tail's index
        # the k largest of a power law all lie `leap` above the next with this probability (Renyi)
        if leap > limits.SPIKE_LEAP and k * np.log(leap) > -np.log(limits.BY_CHANCE) * tail:
            limit = float(rest[0])  # and on: spikes among larger ones leave a leap above themselves, too
    return limit


def _saturation(run: Run, channel: str) -> None:
    """Leave out an effort that stays at one extreme value: there it says nothing of the force."""
    x = run.columns[channel]
    good = x[np.isfinite(x)]
    if len(good) < limits.FEWEST_ROWS or np.ptp(good) == 0 or len(np.unique(good)) < limits.FEWEST_LEVELS:
        return
    for end in (good.max(), good.min()):
        at = x == end
        pairs = int(np.sum(at[1:] & at[:-1]))
        times = int(np.sum(at[1:-1] & at[2:] & ~at[:-2]))  # a steady load is held once
        held = times >= limits.FEWEST_ENDS and pairs > max(limits.AT_END * len(good), 10)
        if held and abs(end) > 0.9 * np.abs(good).max():
            note = f"{int(at.sum())} rows stay at {end:g}: the end of its range, left out"
            run.repairs.append(Repair("saturation", channel, int(at.sum()), float(end), note))
            run.columns[channel] = np.where(at, np.nan, run.columns[channel])
