"""Compiled recursions over a log: first-order lag with uneven steps, and the elastoplastic (stop) element."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.readers.run import Array
from plant.compiled import entry

PAUSE_S = 2.0  # s without a row: ASSUMPTION, far longer than a lost packet, shorter than a rest between runs


@entry
def lowpass(x: Array, clock: Array, tau: float) -> Array:
    """First-order low pass of x (n,) with time constant `tau` s, starting at zero; steps of `clock` may be
    uneven, and x is zero in a pause."""
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
