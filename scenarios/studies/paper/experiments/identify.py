"""First order plus dead time from open-loop steps, as a process engineer would take it from the log.

What has to be kept out of it (each of these moved the dead time by 5 ms or more, from one start to another):

- The log has a row every second tick of the board, and a command takes effect at either. The effort's column
  tells the row. Every other step up is commanded half a row later. So on average the effort is a quarter of a
  row older than the first row that shows it.
- The gears' torques. At 600 arcsec/s mesh 1 goes round 9 times in two seconds, so steps two seconds apart
  all meet it in one phase. These are taken by the encoder, each direction's in ten phases of the motor's half
  turn, evenly spaced: what repeats with the motor cancels.
- The counter torque moves by whole PWM steps. A step of the effort is a whole multiple of what moves it by
  one. Otherwise its share would be off by up to a tenth.
- Samples 10 ms apart and a model with a corner: the best dead time jumps between samples. The paper's own
  model, second order with dead time, is fitted to the samples; the first order is fitted to its smooth
  response.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import floor

import numpy as np
from scipy.optimize import least_squares

from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.runs import MOTOR_TURN_ARCSEC, Bench
from scenarios.studies.paper.scales import CONTROL_PERIOD_S, EFFORT_SCALE, LOG_PERIOD_S

ABOUT = 600.0  # arcsec/s: the viscous branch.
STEP_SHARE = 0.15  # Of the effort at that speed.
COUNTER_SHARE = 10
"""Steps of the effort that move the counter torque by one (paper 3.3: 10 to 25 %, here 10)."""
SETTLE_S = 6.0  # s before the first step.
RESPONSE, BASE = 100, 30
"""Rows: of a response, 1 s, and those before a step that its baseline is the mean of."""
PHASES = 10  # Of half a turn of the motor, in which a step up is taken, and one down.
APART_ARCSEC = MOTOR_TURN_ARCSEC / 2.0 * (1.0 + 1.0 / PHASES) / 2.0
"""arcsec of the axis from one step to the next."""
HALF_ROW_S = LOG_PERIOD_S / 2.0
HOLD_S = CONTROL_PERIOD_S / 2.0
"""Dead time that a held effort adds in the loop (paper 3.3: dt/2), and that a single step does not show."""


@dataclass(frozen=True)
class FirstOrder:
    """Gain (counts in 5 ms per PWM step), lag (s), dead time (s)."""

    gain: float
    lag_s: float
    dead_s: float


@dataclass(frozen=True)
class SecondOrder:
    """Gain (counts in 5 ms per step), natural frequency (rad/s), damping ratio, dead time (s)."""

    gain: float
    frequency: float
    damping: float
    dead_s: float

    def response(self, t_s: Array) -> Array:
        """Return the step response at times after the step; damping above 1 is two real poles."""
        t, z = np.maximum(0.0, t_s - self.dead_s), self.damping
        root = np.sqrt(complex(z * z - 1.0)) or 1e-6
        one, two = (-self.frequency * (z - root), -self.frequency * (z + root))
        decay = (two * np.exp(one * t) - one * np.exp(two * t)) / (two - one)
        return np.asarray(self.gain * (1.0 - decay.real), dtype=np.float64)


def averaged_step(make: Callable[[], Bench]) -> Array:
    """Return the mean response in counts per step of effort, baseline removed. Rows are 10 ms apart, the
    first one 2.5 ms (on average) after the effort has changed.

    Up and down in turn. Raises ValueError when a log does not show its step.
    """
    bench = make()
    closed = bench.closed_loop(ABOUT, SETTLE_S).after(SETTLE_S / 2.0)
    effort = float(closed.effort.mean())
    size = COUNTER_SHARE * max(1, round(STEP_SHARE * effort / COUNTER_SHARE))
    low, high = round(effort), round(effort) + size
    if not low:
        raise ValueError("no effort keeps the speed: a step from nothing has no speed of its own")
    before = bench.open_loop(low, SETTLE_S)
    speed = {low: float(before.rate[-BASE:].mean()), high: float(before.rate[-BASE:].mean()) * high / low}
    found, place = [], 0.0
    for k in range(2 * PHASES):
        target, sign = (low, -1.0) if k % 2 else (high, 1.0)
        whole = floor(((k + 1) * APART_ARCSEC - place) / speed[target] / LOG_PERIOD_S)
        later_s = HALF_ROW_S if k % 2 else 0.0  # the next one is a step up
        after = bench.open_loop(target, max(RESPONSE + BASE, whole) * LOG_PERIOD_S + later_s)
        shown = np.flatnonzero(np.round(after.effort) == target)
        if not shown.size:
            raise ValueError(f"the log does not show the step to an effort of {target}")
        response = after.counts[shown[0] :][:RESPONSE] - before.counts[-BASE:].mean()
        found.append(sign * response / size)
        place += float(after.rate.sum()) * LOG_PERIOD_S + later_s * float(after.rate[-1])
        speed[target] = max(1.0, float(after.rate.mean()))
        before = after
    return np.asarray(np.mean(found, axis=0), dtype=np.float64)


def second_order(t_s: Array, response: Array) -> SecondOrder:
    """Return the model whose step response fits samples best; t_s: time since the effort changed."""
    settled = max(1e-6, float(response[response.size // 2 :].mean()))
    found = [
        least_squares(
            lambda x: SecondOrder(*x).response(t_s) - response, [settled, frequency, damping, 0.005],
            bounds=([1e-9, 1.0, 0.05, 0.0], [1e3, 1e3, 20.0, 0.2]),
            x_scale=[settled, frequency, 1.0, 0.01],
        )
        for frequency in (10.0, 30.0, 100.0)
        for damping in (0.3, 1.5)
    ]  # fmt: skip
    return SecondOrder(*map(float, min(found, key=lambda each: each.cost).x))


def first_order(model: SecondOrder) -> FirstOrder:
    """Return the first order whose step response is nearest to that of `model` for a second."""
    t: Array = np.arange(1, 1001, dtype=np.float64) * 1e-3
    wanted = model.response(t)
    found = [
        least_squares(
            lambda x: x[0] * (1.0 - np.exp(-np.maximum(0.0, t - x[2]) / x[1])) - wanted,
            [model.gain, lag, dead], bounds=([1e-9, 1e-3, 0.0], [1e3, 5.0, 0.2]),
            x_scale=[model.gain, lag, 0.01],
        )
        for dead in (0.005, 0.015, 0.03, 0.06)
        for lag in (0.01, 0.03, 0.1)
    ]  # fmt: skip
    return FirstOrder(*map(float, min(found, key=lambda each: each.cost).x))


def fit(response: Array) -> FirstOrder:
    """Return the model of the loop for an averaged step (see `averaged_step`). Gain is in counts per step,
    lag and dead time in s, half a period of holding included."""
    t: Array = np.arange(response.size, dtype=np.float64) * LOG_PERIOD_S + HALF_ROW_S / 2.0
    found = first_order(second_order(t, response))
    return FirstOrder(found.gain, found.lag_s, found.dead_s + HOLD_S)


def identify(make: Callable[[], Bench]) -> FirstOrder:
    """Return the identified model; efforts in PWM steps (3000 of them)."""
    assert EFFORT_SCALE == 3000
    return fit(averaged_step(make))
