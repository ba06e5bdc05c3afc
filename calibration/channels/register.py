"""The lagging motor's duty register: it may wait until its share of the effort is a whole step off.

A register that followed every step of the effort would jerk a motor that only holds the counter torque. A
tenth of a small effort is a few steps, so that half a step is some per cent of the lagging motor's volts,
and all one way while the effort grows: as much as a counter torque that is partly lost.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.channels.frame import Frame
from calibration.readers.run import Array
from plant.compiled import entry


@entry
def _register(share: Array, fresh: Array) -> Array:
    """What a register that waits for a whole step holds less what it should (n,), in steps."""
    out = np.zeros(len(share))
    held = 0.0
    for k in range(len(share)):
        if fresh[k] > 0.0 or abs(share[k] - held) >= 1.0:
            held = np.floor(share[k] + 0.5)
        out[k] = held - share[k]
    return out


def register_error(frame: Frame, effort: Array, counter: Array) -> Array:
    """Steps (n,) by which the lagging register is off, from the logged efforts (n,), parts of the supply,
    and the counter torque's share (n,)."""
    steps = np.abs(effort) * frame.scale["effort_full_scale"] * counter
    run: NDArray[np.int64] = frame.run
    fresh = np.concatenate([[1.0], (np.diff(run) != 0).astype(float)])
    return np.asarray(_register(steps, fresh))
