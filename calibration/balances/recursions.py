"""Compiled recursions over a log: first-order lag with uneven steps, and the elastoplastic (stop) element."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array
from plant.compiled import entry

PAUSE_S = 2.0  # s without a row: ASSUMPTION, far longer than a lost packet, shorter than a rest between runs


@entry
def lowpass(x: Array, clock: Array, tau: float) -> Array:
    """First-order low pass of x (n,), `tau` s, from zero; `clock` may be uneven, x is zero in a pause."""
    out = np.empty(len(x))
    state = 0.0
    for k in range(len(x)):
        dt = clock[k] - clock[k - 1] if k > 0 else 0.0
        if dt > PAUSE_S:  # between two runs nothing flows
            state *= np.exp(-dt / tau)
            dt = 0.0
        state = x[k] + (state - x[k]) * np.exp(-max(dt, 0.0) / tau)
        out[k] = state
    return out


@entry
def stop_element(x: Array, fresh: Any, radius: float) -> Array:
    """Elastoplastic element: follows x with slope 1, saturates at +-radius, zero where `fresh`."""
    out = np.empty(len(x))
    state = 0.0
    for k in range(len(x)):
        state = 0.0 if fresh[k] or k == 0 else min(max(state + x[k] - x[k - 1], -radius), radius)
        out[k] = state
    return out


def stop_operator(angle: Array, run: NDArray[np.int64], radius: float) -> Array:
    """The elastoplastic loop: follows the travel with slope 1 and saturates at +-radius; shape like `angle`.

    Zero at a run's start. Sums of them are the Prandtl model of pre-sliding friction.
    """
    fresh = np.concatenate([[True], np.diff(run) != 0])
    return np.asarray(stop_element(np.ascontiguousarray(angle), fresh, float(radius)))
