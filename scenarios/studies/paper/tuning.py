"""Published tuning rules for a PI on a first-order model with dead time.

All are in O'Dwyer's Handbook of PI and PID Controller Tuning Rules (the paper's ref. 15), under their
authors: Ziegler and Nichols (1942, reaction curve); Chien, Hrones and Reswick (1952, servo, without and with
20 % overshoot). Cohen and Coon (1953); Rivera, Morari and Skogestad (1986, improved PI, lambda = 1.7 L).
Skogestad (2003, closed-loop time constant = dead time); Astrom and Hagglund (2006, AMIGO; also the paper's
ref. 16).
"""

from collections.abc import Callable
from dataclasses import dataclass

from scenarios.studies.paper.scales import CONTROL_PERIOD_S


@dataclass(frozen=True)
class FirstOrder:
    """Gain (counts in 5 ms per PWM step), lag (s), dead time (s)."""

    gain: float
    lag_s: float
    dead_s: float


@dataclass(frozen=True)
class Gains:
    """Incremental PI: kp in PWM steps per count in 5 ms, ki in PWM steps per count."""

    kp: float
    ki: float


def _gains(proportional: float, integral_s: float) -> Gains:
    return Gains(proportional, proportional * CONTROL_PERIOD_S / integral_s)


def _cohen_coon(m: FirstOrder) -> Gains:
    r = m.dead_s / m.lag_s
    kc = (0.9 / r + 0.083) / m.gain
    return _gains(kc, m.dead_s * (3.33 + 0.31 * r) / (1.0 + 2.22 * r))


def _amigo(m: FirstOrder) -> Gains:
    dead, lag = m.dead_s, m.lag_s
    kc = (0.15 + (0.35 - dead * lag / (dead + lag) ** 2) * lag / dead) / m.gain
    return _gains(kc, 0.35 * dead + 13.0 * dead * lag**2 / (lag**2 + 12.0 * dead * lag + 7.0 * dead**2))


RULES: dict[str, Callable[[FirstOrder], Gains]] = {
    # reaction curve
    "Ziegler-Nichols": lambda m: _gains(0.9 * m.lag_s / (m.gain * m.dead_s), 3.33 * m.dead_s),
    # servo, without and with overshoot
    "Chien 0 %": lambda m: _gains(0.35 * m.lag_s / (m.gain * m.dead_s), 1.17 * m.lag_s),
    "Chien 20 %": lambda m: _gains(0.6 * m.lag_s / (m.gain * m.dead_s), m.lag_s),
    # quarter decay ratio
    "Cohen-Coon": _cohen_coon,
    # internal model control, improved PI, lambda = 1.7 L
    "Rivera": lambda m: _gains(
        (2.0 * m.lag_s + m.dead_s) / (2.0 * m.gain * 1.7 * m.dead_s), m.lag_s + m.dead_s / 2.0
    ),
    # SIMC with the tightest closed-loop time constant that is advised
    "Skogestad": lambda m: _gains(m.lag_s / (2.0 * m.gain * m.dead_s), min(m.lag_s, 8.0 * m.dead_s)),
    # largest integral gain at a maximum sensitivity of 1.4
    "AMIGO": _amigo,
}
