"""Rows of a log that repeat the row before, rows that are missing, and time stamps that shake while the
samples are taken on time. The position says which of the two it was."""

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask, by_median
from calibration.inputs import thresholds as limits
from calibration.inputs.declaration import Rig
from calibration.inputs.run import Repair, Run, quantum

BEND_OF_NOISE = 20**0.5  # times a row's noise, in a third difference: 1, 3, 3 and 1 squared. arithmetic
STILL = ("time", "temperature", "supply", "reference")  # slow, or computed: they do not come with the frame


def lost_rows(run: Run) -> None:
    """Note single rows that are missing here and there from a clock that is regular otherwise."""
    steps = np.diff(run.columns["t"]) / run.period_s
    whole = np.round(steps)
    regular = np.abs(steps - whole) < limits.OFF_BEAT
    if len(steps) < limits.FEWEST_ROWS or regular.mean() < limits.REGULAR or not _moved_on(run, whole):
        return
    at = regular & (whole >= 2)
    rows = int((whole[at] - 1).sum())
    if at.sum() >= limits.LOST_PLACES and rows > limits.LOST_SHARE * run.rows:
        note = f"{rows} rows are missing in {int(at.sum())} places"
        run.repairs.append(Repair("lost", "all", rows, float(rows), note))


def rows_without_a_stamp(run: Run) -> None:
    """Put rows later by those that are missing before them; in place.

    An even clock goes on as if there were none: it was made from the row's number. The position moves on by
    whole rows there.
    """
    t, travel = run.columns["t"], np.diff(run.columns["position"])
    even = np.abs(np.diff(t) / run.period_s - 1) < limits.OFF_BEAT
    if len(t) < limits.FEWEST_ROWS or even.mean() < limits.REGULAR:
        return
    x = run.columns["position"][np.isfinite(run.columns["position"])]
    noise = by_median(np.diff(x, 3)) / BEND_OF_NOISE
    least = limits.STEPS_PER_ROW * max(quantum(x) or 0.0, np.sqrt(12.0) * noise)
    near = np.sort([np.roll(travel, k) for k in (-2, -1, 1, 2)], axis=0)
    usual, apart = (near[1] + near[2]) / 2, near[2] - near[1]
    clear = np.abs(usual) > np.maximum(least, apart / limits.LIKE_ITS_NEIGHBOUR)
    clear &= np.all([np.roll(even, k) for k in (-2, -1, 0, 1, 2)], axis=0)
    clear[[0, 1, -2, -1]] = False
    rows = np.where(clear, travel / np.where(clear, usual, 1.0), 1.0)
    whole = np.maximum(np.rint(rows), 1.0)
    sure = np.abs(rows - whole) < limits.OFF_BEAT
    lost, count = sure & (whole > 1), int((whole - 1)[sure].sum())
    if lost.sum() < limits.LOST_PLACES or count <= limits.LOST_SHARE * run.rows:
        return
    if (~sure).sum() > limits.BETWEEN * lost.sum():
        return  # steps of every size are the motion's own
    run.columns["t"] = t + run.period_s * np.concatenate([[0.0], np.cumsum(np.where(lost, whole - 1, 0.0))])
    note = (
        f"{count} rows are missing in {int(lost.sum())} places, though the stamps go on: rows are put later"
    )
    run.repairs.append(Repair("lost", "all", count, float(count), note))


def _moved_on(run: Run, whole: Array) -> bool:
    """Whether over steps (n - 1,) of `whole` periods the drive moved on as the clock did. Over a stamp that
    jumps it moves by one row, over a rest not at all."""
    step = np.nan_to_num(np.abs(np.diff(run.columns["position"])))
    usual = np.maximum(np.roll(step, 1), np.roll(step, -1))
    wide = whole >= 2
    expected = float(np.sum((usual * whole)[wide]))
    moved = float(np.sum(np.minimum(step, usual * whole)[wide]))
    return moved > limits.MOVED_ON * expected or expected == 0.0


def repeated_rows(run: Run, rig: Rig) -> None:
    """Rows in which every moving column repeats the row before while the motion goes on: a frame was lost."""
    present = [c for c in rig.columns if c in run.columns and c not in STILL]
    if len(present) < 2 or run.rows < limits.FEWEST_ROWS:
        return
    same = np.all([np.diff(run.columns[c]) == 0 for c in present], axis=0)
    x = run.columns["position"]
    usual = float(np.nanmedian(np.abs(np.diff(x))))
    step = quantum(x[np.isfinite(x)]) or 0.0
    coarse = usual < limits.COARSE_STEPS * step  # such a column repeats itself anyway
    if usual == 0 or coarse or not same.any():
        return
    quick = np.abs(np.nan_to_num(x[2:] - x[:-2])) > usual  # over two rows it moved
    lost = np.concatenate([[False], same[:-1] & quick, [False]])
    if not limits.FEWEST_REPEATS <= lost.sum() <= limits.MOST_REPEATS * run.rows:
        return
    for c in present:
        run.columns[c] = np.where(lost, np.nan, run.columns[c])
    note = f"{int(lost.sum())} rows repeat the row before while the drive moves: left out"
    run.repairs.append(Repair("repeat", "all", int(lost.sum()), float(lost.sum()), note))


def steady_stamps(run: Run) -> None:
    """Put the rows on an even grid where the position says that they were taken on one; in place."""
    t, x = run.columns["t"], run.columns["position"]
    if len(t) < limits.FEWEST_ROWS:
        return
    place = _places(t, run.period_s)
    grid = np.polyval(np.polyfit(place, t, 2), place)
    shake = float(np.std(t - grid))
    if shake < limits.LEAST_SHAKE * run.period_s or shake > 0.5 * run.period_s:
        return  # a clock that wanders by whole samples is no jitter
    even, stamped, rows = _bends(place, x), _bends(t, x), _quick(place, x)
    if rows.sum() < limits.FEWEST_ROWS:
        return
    left, right = float(np.mean(even[rows] ** 2)), float(np.mean(stamped[rows] ** 2))
    if not left < limits.EVEN_BETTER * right:
        return
    run.columns["t"] = grid - grid[0]
    run.period_s = float(np.median(np.diff(grid)))
    rounding = shake < limits.ROUNDED * _digits(t) / np.sqrt(12.0)
    kind, why = ("rounded", "their own step") if rounding else ("jitter", "the samples were taken evenly")
    note = f"time stamps shake by {1000 * shake:.3g} ms rms, {why}: rows are put on an even grid"
    run.repairs.append(Repair(kind, "time", len(t), shake, note))


def _places(t: Array, period_s: float) -> Array:
    """Sample number of every row: one on from the row before. It is more where rows are missing, which is
    where the rows on either side are far apart, too."""
    step = np.diff(t) / period_s
    pairs = step[1:] + step[:-1]
    apart = np.minimum(np.append(pairs, np.inf), np.insert(pairs, 0, np.inf))
    one = (step < limits.STAMP_GAP) | (apart < 1.0 + limits.STAMP_GAP)
    return np.concatenate([[0.0], np.cumsum(np.where(one, 1.0, np.rint(step)))])


def _digits(t: Array) -> float:
    """The decimal step that all stamps are multiples of, s."""
    steps = (float(step) for step in 10.0 ** -np.arange(7.0))
    return next((s for s in steps if np.allclose(t / s, np.rint(t / s), atol=1e-4, rtol=0.0)), 0.0)


def _bends(t: Array, x: Array) -> Array:
    """What the straight line between its neighbours leaves of every row (n,); NaN where there is none."""
    out = np.full(len(x), np.nan)
    part = (t[1:-1] - t[:-2]) / np.maximum(t[2:] - t[:-2], 1e-300)
    out[1:-1] = x[1:-1] - x[:-2] - (x[2:] - x[:-2]) * part
    return out


def _quick(place: Array, x: Array) -> Mask:
    """Rows between two neighbours, quicker than most: there the sensor's own steps matter least."""
    one, speed = np.diff(place) == 1, np.abs(np.gradient(x))
    whole = np.concatenate([[False], one[:-1] & one[1:], [False]])
    whole &= np.isfinite(_bends(place, x))
    least = np.quantile(speed[whole], limits.QUICK_SHARE) if whole.any() else np.inf
    return np.asarray(whole & (speed > least))


def jumps_of_clock(x: Array, steps: NDArray[np.int64]) -> Mask:
    """Which of the steps (n - 1,), in periods, between rows at positions x (n,) are the clock's alone. There
    the position went on by one row's motion, and not by theirs.

    The motion is that of limits.BESIDE_A_GAP rows on either side, which go one way; at rest nothing tells.
    """
    travel = np.diff(x)
    out = np.zeros(len(steps), dtype=bool)
    for at in map(int, np.flatnonzero(steps > 1)):
        first = max(at - limits.BESIDE_A_GAP, 0)
        near = np.delete((travel / steps)[first : at + 1 + limits.BESIDE_A_GAP], at - first)
        near = near[np.isfinite(near)]
        if len(near) > limits.BESIDE_A_GAP and abs(np.sign(near).sum()) == len(near):
            usual = float(np.median(near))
            out[at] = abs(travel[at] - usual) < abs(travel[at] - usual * steps[at])
    return out
