"""The emulator beside models of it: equation (6) with the same PI, and tuning rules (E9, E10).

The rules are for a PI on a first-order model with dead time. All are in O'Dwyer's Handbook of PI and PID
Controller Tuning Rules (the paper's ref. 15), under their authors:

- Ziegler and Nichols (1942), reaction curve.
- Chien, Hrones and Reswick (1952), servo, without and with 20 % overshoot.
- Cohen and Coon (1953), quarter decay ratio.
- Rivera, Morari and Skogestad (1986), improved PI, lambda = 1.7 L.
- Skogestad (2003), closed-loop time constant = dead time, the tightest that is advised.
- Astrom and Hagglund (2006), AMIGO, largest integral gain at a maximum sensitivity of 1.4 (also ref. 16).
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import exp, log

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.identify import FirstOrder, identify
from scenarios.studies.paper.linear import beside
from scenarios.studies.paper.runs import STEP_TO, step
from scenarios.studies.paper.scales import CONTROL_PERIOD_S
from scenarios.studies.paper.starts import Benches


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
    "Ziegler-Nichols": lambda m: _gains(0.9 * m.lag_s / (m.gain * m.dead_s), 3.33 * m.dead_s),
    "Chien 0 %": lambda m: _gains(0.35 * m.lag_s / (m.gain * m.dead_s), 1.17 * m.lag_s),
    "Chien 20 %": lambda m: _gains(0.6 * m.lag_s / (m.gain * m.dead_s), m.lag_s),
    "Cohen-Coon": _cohen_coon,
    "Rivera": lambda m: _gains(
        (2.0 * m.lag_s + m.dead_s) / (2.0 * m.gain * 1.7 * m.dead_s), m.lag_s + m.dead_s / 2.0
    ),
    "Skogestad": lambda m: _gains(m.lag_s / (2.0 * m.gain * m.dead_s), min(m.lag_s, 8.0 * m.dead_s)),
    "AMIGO": _amigo,
}


@row("E9")
def equation_6(benches: Benches) -> Figures:
    """Difference of the two responses from rest to 600 arcsec/s, and their settled efforts."""
    measured = step(benches("low"))
    _, rate, effort = beside(benches, measured)
    rate, effort = rate[1::2], effort[1::2]  # the log has every second tick
    late = slice(-rate.size // 3, None)
    return {
        "difference": float(np.sqrt(np.mean((measured.rate - rate) ** 2)) / STEP_TO * 100.0),
        "effort": (float(effort[late].mean()) / float(measured.effort[late].mean()) - 1.0) * 100.0,
    }


@row("E10", tuple((name, "factor") for name in RULES))
def tuning_rules(benches: Benches) -> Figures:
    """Factors between the plant file's gains and each rule's, for a model identified on the emulator."""
    model = identify(lambda: benches("low"))
    own = Gains(*benches.gains)
    found = {name: factor(own, rule(model)) for name, rule in RULES.items()}
    nearest = sorted(found.values())
    return {
        "nearest": nearest[0],
        "second": nearest[1],
        "gain": model.gain,
        "lag": model.lag_s * 1e3,
        "dead time": model.dead_s * 1e3,
    } | found


def factor(one: Gains, other: Gains) -> float:
    """Return the larger of the two factors between gains, 1 or more."""
    return exp(max(abs(log(one.kp / other.kp)), abs(log(one.ki / other.ki))))
