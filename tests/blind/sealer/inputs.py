"""Per-tick inputs of a run that an effect brings: torques, command upsets, hidden set points, bursts."""

from typing import NamedTuple

import numpy as np
from scipy.signal import lfilter

from tests.blind.sealer import declared as d
from tests.blind.sealer.manoeuvres import COUNTS_PER_RATE, Run
from tests.blind.sealer.slots import Array


class Inputs(NamedTuple):
    """Arrays of one value per 5 ms tick."""

    hidden: Array
    torque: Array
    upset: Array
    burst: Array


def wind(rng: np.random.Generator, n: int, sigma: float, corner_hz: float, mean: float) -> Array:
    """First-order low-passed noise of the given sigma, plus mean x sigma."""
    a = float(np.exp(-d.TURN * corner_hz * d.TICK_S))
    noise = rng.standard_normal(n) * sigma * np.sqrt(1.0 - a * a)
    series: Array = lfilter([1.0], [1.0, -a], noise)
    return series + mean * sigma


def other_axis(t: Array, amplitude: float, period: float) -> Array:
    """Push and pull of 0.8 s at the start and the end of every other slew of the other axis."""
    phase = np.mod(t, 2.0 * period)
    up = (phase < 0.8) | (np.abs(phase - 1.6 * period) < 0.4)
    down = np.abs(phase - 0.7 * period) < 0.4
    out: Array = amplitude * (up.astype(float) - down.astype(float))
    return out


def inputs(run: Run, values: dict[str, float], seed: int) -> Inputs:
    """The inputs of one run for these effect values; the same seed gives the same noise at any size."""
    n = len(run.command)
    rng = np.random.default_rng(seed)
    t: Array = run.t_session + d.TICK_S * np.arange(n, dtype=np.float64)
    hidden, torque, upset, burst = (np.zeros(n) for _ in range(4))
    if "WIND" in values:
        torque += wind(rng, n, values["WIND"], values["WIND_CORNER"], values["WIND_MEAN"])
    if "OTHER" in values:
        torque += other_axis(t, values["OTHER"], values["OTHER_PERIOD"])
    if "UPSET" in values:
        upset += values["UPSET"] * np.sin(d.TURN * values["UPSET_F"] * t + values["UPSET_PH"])
    if "PULSE" in values:
        on = np.mod(t, values["PULSE_PERIOD"]) < values["PULSE_LENGTH"]
        scale = COUNTS_PER_RATE if run.loop == "closed" else 1.0
        hidden += values["PULSE"] * scale * on
    if "BRUSH_A" in values:
        burst += (np.mod(t, 9.0) < 4.0) & (t > 20.0)
    return Inputs(hidden, torque, upset, burst)
