"""First order plus dead time from open-loop steps, as a process engineer would take it from the log."""

from collections.abc import Callable

import numpy as np
from scipy.optimize import least_squares

from scenarios.paper.bench import Bench
from scenarios.paper.log import Array
from scenarios.paper.scales import EFFORT_SCALE, LOG_PERIOD_S
from scenarios.paper.tuning import FirstOrder

ABOUT = 600.0
"""arcsec/s: the viscous branch."""
STEP_SHARE = 0.15
"""Of the effort at that speed."""
SETTLE_S, STEP_S = 6.0, 1.0
REPEATS = 3


def averaged_step(make: Callable[[], Bench]) -> Array:
    """Return the mean response in counts per step of effort, every 10 ms from the step on, baseline removed.

    Up and down `REPEATS` times from one place after the other, so that what the gears do averages out.
    """
    bench = make()
    closed = bench.closed_loop(ABOUT, SETTLE_S).after(SETTLE_S / 2.0)
    effort = float(closed.effort.mean())
    size = max(4, round(STEP_SHARE * effort))
    low, high = round(effort), round(effort) + size
    bench.open_loop(low, SETTLE_S)
    found = []
    for _ in range(REPEATS):
        for sign, target in ((1.0, high), (-1.0, low)):
            before = bench.open_loop(low if sign > 0 else high, STEP_S)
            after = bench.open_loop(target, STEP_S)
            base = float(before.counts[-30:].mean())
            found.append(sign * (after.counts - base) / size)
    shortest = min(response.size for response in found)
    return np.asarray(np.mean([response[:shortest] for response in found], axis=0), dtype=np.float64)


def fit(response: Array, period_s: float = LOG_PERIOD_S) -> FirstOrder:
    """Return the model whose step response fits best: gain in counts per step, lag and dead time in s."""
    t = (np.arange(response.size) + 1.0) * period_s

    def model(x: Array) -> Array:
        gain, lag, dead = x
        return np.asarray(gain * (1.0 - np.exp(-np.maximum(0.0, t - dead) / lag)), dtype=np.float64)

    settled = float(response[response.size // 2 :].mean())
    best = None
    for lag in (0.01, 0.03, 0.1):
        found = least_squares(
            lambda x: model(x) - response, [max(1e-6, settled), lag, 0.005],
            bounds=([1e-9, 1e-3, 0.0], [1e3, 5.0, 0.2]), x_scale=[max(1e-6, settled), lag, 0.005],
        )  # fmt: skip
        if best is None or found.cost < best.cost:
            best = found
    assert best is not None
    gain, lag, dead = (float(v) for v in best.x)
    return FirstOrder(gain, lag, max(dead, MINIMUM_DEAD_S))


MINIMUM_DEAD_S = 0.005
"""s: half a period of holding and half of counting (paper: Delta t / 2 for the sampling) are always there;
samples every 10 ms cannot show less."""


def identify(make: Callable[[], Bench]) -> FirstOrder:
    """Return the identified model; efforts in PWM steps (3000 of them)."""
    assert EFFORT_SCALE == 3000
    return fit(averaged_step(make))
