"""Directions of a motion, and the travel since it last turned."""

import itertools

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array


def turning_points(angle: Array, run: NDArray[np.int64], travel: float) -> NDArray[np.bool_]:
    """True at every extreme that is followed by more than `travel` the other way, and where a run starts."""
    out = np.zeros(len(angle), dtype=bool)
    start = low = high = heading = 0  # low, high: the extremes since the last turn
    values, runs = angle.tolist(), run.tolist()
    for k in range(1, len(values)):
        if runs[k] != runs[k - 1]:
            out[k] = True
            start = low = high = k
            heading = 0
            continue
        low = k if values[k] < values[low] else low
        high = k if values[k] > values[high] else high
        if heading <= 0 and values[k] - values[low] > travel:
            out[low] |= low > start
            heading, high = 1, k
        elif heading >= 0 and values[high] - values[k] > travel:
            out[high] |= high > start
            heading, low = -1, k
    return out


def direction_of(angle: Array, run: NDArray[np.int64], travel: float) -> Array:
    """-1 or 1 between turning points of at least `travel`; zero in a run that does not move that far."""
    marks = np.flatnonzero(turning_points(angle, run, travel))
    edges = np.concatenate([[0], marks, [len(angle)]])
    out = np.zeros(len(angle))
    for a, b in itertools.pairwise(edges):
        if b > a:
            moved = angle[b - 1 if b == len(angle) or run[b] != run[b - 1] else b] - angle[a]
            out[a:b] = np.sign(moved) if abs(moved) > travel else 0.0
    return out


def since_reversal(angle: Array, direction: Array, run: NDArray[np.int64]) -> Array:
    """Travel since the last change of direction (or the run's start), same unit as `angle`."""
    change = np.ones(len(angle), dtype=bool)
    change[1:] = (np.diff(direction) != 0) | (np.diff(run) != 0)
    index = np.where(change, np.arange(len(angle)), 0)
    np.maximum.accumulate(index, out=index)
    return angle - angle[index]
