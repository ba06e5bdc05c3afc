"""What is wrong with columns before any physics: counters that wrap, signed numbers written unsigned, spikes,
samples that repeat, readings at the end of their range."""

from __future__ import annotations

import numpy as np

from calibration.inputs.declaration import Rig
from calibration.inputs.frames import lost_rows, repeated_rows
from calibration.inputs.record import Record, Repair
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

WORDS = tuple(2.0**k for k in range(8, 33))
CIRCLES = (1.0, 24.0, 360.0, 2 * np.pi, 86400.0, 1296000.0, 400.0, 1000.0)
MOVED = 3.0  # of what all but one row in a hundred move, that a row with a wrap may
NEAR = 0.2  # of the counter's length, by which a wrap's jump may differ: what is moved in one row
SPIKE = 12.0  # robust deviations from the neighbours' line
LEAP = 2.5  # between the smallest spike and the largest of the rest
TAIL = 20  # values below the leap, from which the tail's index is taken (Hill 1975)
BY_CHANCE = 1e-4  # of a leap that a heavy tail makes by itself
MOST_SPIKES = 0.01  # of rows: more is no spike but the signal
MOVING = ("position", "position2", "velocity", "reference")
SLOW = ("supply", "temperature", "normal")  # what leaps there may be real
# times what all but one row in 200 move; leaps a file may have; rows that must lie between two, or they are
# spikes
LEAPS, MOST_LEAPS, SETTLED = 10.0, 3, 20
FEWEST_ENDS = 3  # stretches at one extreme value, before it is an end of the range
AT_END = 0.002  # of rows at one extreme value, in stretches: the reading is at its end


def repair(record: Record, rig: Rig) -> None:
    """Repair the record's columns in place; what was done is in `record.repairs`."""
    for channel, where in rig.columns.items():
        if channel == "time":
            continue
        x = record.columns[channel]
        raw = (x - where.offset) / where.scale
        if where.wrap is None:
            raw, found = _undeclared_wrap(raw, channel)
            if found is not None:
                size = found.size * abs(where.scale)
                record.repairs.append(Repair(found.kind, channel, found.rows, size, found.note))
                x = raw * where.scale + where.offset
        if channel == "position":
            x = _leaps(record, x)
        bad = _spikes(x, record.columns["t"], record.period_s)
        if channel not in SLOW and bad.any():
            size = float(np.nanmax(np.abs(x[bad] - np.nanmedian(x))))
            rows = ", ".join(str(k + 1) for k in np.flatnonzero(bad)[:5])
            note = f"rows {rows}{' …' if bad.sum() > 5 else ''} are far off their neighbours: left out"
            record.repairs.append(Repair("spike", channel, int(bad.sum()), size, note))
            x = np.where(bad, np.nan, x)
        if channel in ("effort", "current", "force"):
            x = _saturation(record, channel, x)
        record.columns[channel] = x
    repeated_rows(record, rig)
    lost_rows(record)


def _undeclared_wrap(raw: Array, channel: str) -> tuple[Array, Repair | None]:
    """Undo jumps by the whole length of a counter that nobody declared."""
    good = np.flatnonzero(np.isfinite(raw))
    x = raw[good]
    if len(x) < 50:
        return raw, None
    span = float(x.max() - x.min())
    step = np.diff(x)
    usual = float(np.quantile(np.abs(step), 0.75))  # quick motion may wrap in every tenth row
    jumps = np.abs(step) > max(0.5 * span, 4 * usual)
    if span <= 0 or not jumps.any() or jumps.mean() > 0.2:
        return raw, None
    size = float(np.median(np.abs(step[jumps])))
    integers = bool(np.allclose(x, np.round(x)))
    lengths = [
        w for w in (WORDS if integers else CIRCLES) + ((360.0,) if integers else ()) if w >= span * 0.999
    ]
    length = min(lengths, key=lambda w: abs(w - size), default=0.0)
    if not length or abs(length - size) > NEAR * length or not _is_counter(x, step, jumps, length):
        return raw, None
    out = raw.copy()
    out[good] = np.unwrap(x, period=length)
    # there and back in a row or two is a spike, not a wrap
    turns = np.round((out[good] - x) / length)
    runs = np.diff(np.flatnonzero(np.concatenate([[True], np.diff(turns) != 0, [True]])))
    if len(runs) > 2 and np.max(runs[1:-1]) <= 2 and runs[1:-1].sum() < 0.01 * len(x):
        return raw, None
    if np.abs(np.diff(out[good])).max() > 0.5 * span:
        return raw, None
    count = int(np.count_nonzero(np.diff(turns)))
    kind, note = "wrap", f"a counter of {length:g} wraps: joined"
    signed = integers and channel not in MOVING and np.ptp(turns) == 1
    if signed:
        high = x > length / 2
        out[good] = np.where(high, x - length, x)
        kind, note = "signed", f"signed numbers of {length:g} values written unsigned: {length - 1:g} is -1"
    return out, Repair(kind, channel, count, length, note)


def _is_counter(x: Array, step: Array, jumps: Mask, length: float) -> bool:
    """Whether jumps are a counter's and not the column's own: a counter jumps by its length less what moves
    in a row; or the column uses it from end to end, and then a real step may fall on a wrap."""
    moved = MOVED * float(np.quantile(np.abs(step[~jumps]), 0.99)) + 2.0 * _least_step(step)
    if np.mean(np.abs(np.abs(step[jumps]) - length) <= min(moved, NEAR * length)) >= 0.9:
        return True
    return bool(length in WORDS and np.ptp(x) >= length - 1 - moved)


def _least_step(step: Array) -> float:
    some = np.abs(step[step != 0])
    return float(some.min()) if len(some) else 0.0


def _spikes(x: Array, t: Array, period: float) -> np.ndarray:
    """Rows far off the line through their neighbours, which agree with each other."""
    n = len(x)
    bad = np.zeros(n, dtype=bool)
    if n < 50:
        return bad
    for width in (1, 2):  # single rows, then pairs
        before, after = np.roll(x, width), np.roll(x, -width)
        off = x - (before + after) / 2
        off[:width], off[-width:] = 0.0, 0.0
        wide_before, wide_after = np.roll(x, width + 1), np.roll(x, -width - 1)
        calm = np.abs((before + after) / 2 - (wide_before + wide_after) / 2)
        near = np.abs(after - before)
        finite = np.isfinite(off)
        if finite.sum() < 50:
            return bad
        noise = 1.4826 * float(np.nanmedian(np.abs(off)))
        noise = max(noise, float(np.nanquantile(np.abs(off), 0.95)) / 2)
        extreme = np.abs(off) > SPIKE * noise
        alone = np.abs(off) > 4 * np.maximum(near, calm)
        found = np.asarray(finite & extreme & alone & (noise > 0))
        bad |= found & (np.abs(off) > _clear_of_tails(np.abs(np.nan_to_num(off)), n))
    gap = np.zeros(n, dtype=bool)
    gap[1:] = np.diff(t) > 2.5 * period
    bad &= ~(gap | np.roll(gap, -1))
    return bad if bad.sum() <= max(3, MOST_SPIKES * n) else np.zeros(n, dtype=bool)


def _leaps(record: Record, x: Array) -> Array:
    """Join a position that moves by a constant from one row to the next while the motion goes on: a counter
    that lost its zero."""
    step = np.diff(x)
    size = np.abs(step[np.isfinite(step)])
    if len(size) < 200 or np.any(np.diff(record.columns["t"]) > 2.5 * record.period_s):
        return x
    usual = LEAPS * float(np.quantile(size, 0.995))
    at = np.flatnonzero(np.abs(np.nan_to_num(step)) > max(usual, 20 * _least_step(step)))
    if not 0 < len(at) <= MOST_LEAPS or (len(at) > 1 and np.diff(at).min() <= SETTLED) or usual == 0:
        return x
    out = x.copy()
    for k in at:
        around = np.concatenate([step[max(k - 3, 0) : k], step[k + 1 : k + 4]])
        excess = float(step[k] - np.nanmedian(around))
        out[k + 1 :] -= excess
        note = f"leaps by {excess:.4g} between rows {k + 1} and {k + 2}: joined"
        record.repairs.append(Repair("leap", "position", 1, excess, note))
    return out


def _clear_of_tails(off: Array, n: int) -> float:
    """Size from which on values are a group of their own: heavy tails thin out, spikes leave a gap."""
    top = off.copy()
    for shift in (-2, -1, 1, 2):  # a spike moves its neighbours' lines, too
        top[off < np.roll(off, shift)] = 0.0
    most = max(int(MOST_SPIKES * n), 3)
    largest = np.sort(top)[::-1][: most + 1 + TAIL]
    limit = float("inf")
    for k in range(1, min(most + 1, len(largest) - TAIL)):
        rest = largest[k : k + TAIL + 1]
        if rest[0] <= 0 or rest[-1] <= 0:
            return float(rest[0])
        leap = largest[k - 1] / rest[0]
        tail = float(np.mean(np.log(rest[:-1] / rest[-1])))  # Hill's estimate of 1 / the tail's index
        # the k largest of a power law all lie `leap` above the next with this probability (Renyi)
        if leap > LEAP and k * np.log(leap) > -np.log(BY_CHANCE) * tail:
            limit = float(rest[0])  # and on: spikes among larger ones leave a leap above themselves, too
    return limit


def _saturation(record: Record, channel: str, x: Array) -> Array:
    """Leave out an effort that stays at one extreme value: there it says nothing of the force."""
    good = x[np.isfinite(x)]
    if len(good) < 200 or np.ptp(good) == 0 or len(np.unique(good)) < 20:
        return x
    out = x.copy()
    for end in (good.max(), good.min()):
        at = x == end
        pairs = int(np.sum(at[1:] & at[:-1]))
        times = int(np.sum(at[1:-1] & at[2:] & ~at[:-2]))  # a steady load is held once
        if (
            times >= FEWEST_ENDS
            and pairs > max(AT_END * len(good), 10)
            and abs(end) > 0.9 * np.abs(good).max()
        ):
            note = f"{int(at.sum())} rows stay at {end:g}: the end of its range, left out"
            record.repairs.append(Repair("saturation", channel, int(at.sum()), float(end), note))
            out[at] = np.nan
    return out
