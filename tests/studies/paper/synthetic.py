"""Logs with known contents, made by arithmetic only."""

import numpy as np

from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, COUNT_RATE, GEAR_RATIO, LOG_PERIOD_S


def log_of(rate: Array, effort: Array | None = None, current: Array | None = None) -> Log:
    """A log of a velocity record (arcsec/s, every 10 ms), its counts not rounded; current of motor A in A."""
    n = rate.size
    zero = np.zeros(n)
    amperes = zero if current is None else current
    t = np.arange(n) * LOG_PERIOD_S
    return Log(
        t,
        rate / COUNT_RATE,
        zero if effort is None else effort,
        amperes / ADC_A_PER_COUNT,
        zero.copy(),
        rate.copy(),
    )


def current_for(torque: Array, torque_constant: float) -> Array:
    """Current of motor A that gives a torque at the axis, A."""
    return torque / (torque_constant * GEAR_RATIO)
