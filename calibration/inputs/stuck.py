"""Columns that hold one number while the drive moves under them, and columns that stop at the end of their
converter. A column of the first kind measures nothing. Noise would spread one of the second over the
neighbouring counts."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from calibration.arrays import Array, Mask
from calibration.errors import CalibrationInputError
from calibration.inputs import thresholds as limits
from calibration.inputs.declaration import Rig
from calibration.inputs.run import Run, numbers


def check_counted(run: Run, factors: dict[str, float], first: int) -> None:
    """Raise CalibrationInputError for a rate or an encoder that never changes although it must have.

    The position says that it must have changed by more than MISSED counts.
    `factors` are SI units per count of the axis log `run`, `first` is the line of its first row.
    """
    good = np.isfinite(run.columns["position"])
    if good.sum() < limits.FEWEST_MOVED:
        return
    t, x = run.columns["t"][good], run.columns["position"][good]
    span = t[limits.RATE_ROWS :] - t[: -limits.RATE_ROWS]
    whole = (span > 0) & ~_leaps(x)
    rate = (x[limits.RATE_ROWS :] - x[: -limits.RATE_ROWS])[whole] / span[whole]
    motor = rate * run.scales["gear_ratio"]
    for name, motion in (("velocity", rate), ("tach_a", motor), ("tach_b", motor), ("aux", x)):
        held = _held(run.raw.get(name, np.zeros(0)))
        if held is None or len(motion) < limits.FEWEST_MOVED:
            continue
        if float(np.ptp(np.quantile(motion, [0.01, 0.99]))) > limits.MISSED * factors[name]:
            _refuse(run.path, held, name, first)


def check_stuck(records: list[Run], rig: Rig) -> None:
    """Raise CalibrationInputError for a response or a measured rate that never changes although the position
    does: it explains nothing, and nothing explains it."""
    position = numbers(records, "position")
    if np.ptp(position) <= limits.MOVED * float(np.abs(position).max()):
        return
    wanted = [r.channel for r in rig.responses if r.channel != "position"]
    wanted += ["velocity", "acceleration", "motor_a", "motor_b", *["effort"] * (rig.motors is not None)]
    for channel in dict.fromkeys(wanted):
        if channel in rig.columns and (held := _held(numbers(records, channel))) is not None:
            _refuse(records[0].path, held, str(rig.columns[channel].column))


def _leaps(x: Array) -> Mask:
    """Whether each stretch of RATE_ROWS rows holds a step that no motion makes: of a counter that wraps."""
    step = np.abs(np.diff(x))
    beside = np.maximum(np.append(step[1:], 0.0), np.insert(step[:-1], 0, 0.0))
    before = np.concatenate([[0], np.cumsum(step > limits.QUICKER * beside + limits.FAR_RAD)])
    return np.asarray(before[limits.RATE_ROWS :] > before[: -limits.RATE_ROWS])


def _held(x: Array) -> float | None:
    """The number that all rows of `x` (n,) hold; None where they differ, or there are none."""
    good = x[np.isfinite(x)]
    return float(good[0]) if len(good) and np.ptp(good) == 0 else None


def _refuse(path: Path, held: float, column: str, first: int | None = None) -> None:
    what = f"holds {held:g} in every row while the position moves: it measures nothing, leave it out"
    raise CalibrationInputError(path, what, first, column)


def piled_at(x: Array, effort: Array, end: float, before: float) -> tuple[int, int] | None:
    """Rows of `x` (n,) at its `end`, and at `before`, a count nearer; None where they do not pile up there.
    `effort` (n,) is what drives it."""
    at = x == end
    if not at.any() or np.ptp(effort[at]) < limits.DRIVEN * np.ptp(effort):
        return None
    piled, next_to = int(at.sum()), int(np.sum(np.abs(x - before) < 0.1 * abs(end - before)))
    crowded = piled >= limits.PILE and piled > limits.PILE_TIMES * next_to + limits.PILE_BESIDE
    return (piled, next_to) if crowded else None


def converter_end(runs: Sequence[Run], names: Sequence[str]) -> float | None:
    """What the currents `names` of two motors stop at in all runs; None where they pile up nowhere."""
    have = [n for n in names if all(n in r.columns for r in runs)]
    pairs = (np.array((r.columns[n], r.columns["effort"])) for n in have for r in runs)
    both = np.hstack([np.zeros((2, 0)), *pairs])
    x, effort = both[:, np.isfinite(both).all(axis=0)]
    below = x[x < x.max(initial=-np.inf)]
    if not len(below):  # nothing, or one number, which has no end
        return None
    end = float(x.max())
    return end if piled_at(x, effort, end, float(below.max())) is not None else None
