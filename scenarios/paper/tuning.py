"""A published tuning rule for a PI on a second-order-plus-dead-time model.

Skogestad, "Simple analytic rules for model reduction and PID controller tuning", J. Process Control 13
(2003) 291, and its "smooth" use, Ind. Eng. Chem. Res. 45 (2006) 7817; one of the internal-model rules that
O'Dwyer's Handbook of PI and PID Controller Tuning Rules (the paper's ref. 15) lists. The half rule makes the
second order a first: tau = slow + fast/2, theta = dead + fast/2; then Kc = tau / (k (tau_c + theta)), Ti =
min(tau, 4 (tau_c + theta)). tau_c is the rule's one free number: the wanted closed-loop time constant; tau_c
= theta is the tightest advised.
"""

from dataclasses import dataclass

from scenarios.paper.linear import DeadTimeModel
from scenarios.paper.scales import CONTROL_PERIOD_S


@dataclass(frozen=True)
class Gains:
    """Incremental PI: kp in PWM steps per count in 5 ms, ki in PWM steps per count."""

    kp: float
    ki: float


def simc(model: DeadTimeModel, closed_s: float | None = None) -> Gains:
    """Return the rule's gains for a wanted closed-loop time constant, s; None: the tightest advised."""
    tau = model.slow_s + model.fast_s / 2.0
    theta = model.dead_s + model.fast_s / 2.0
    wanted = theta if closed_s is None else closed_s
    if wanted <= -theta:
        raise ValueError(f"closed-loop time constant {wanted} s is not above minus the dead time {theta} s")
    kc = tau / (model.gain * (wanted + theta))
    ti = min(tau, 4.0 * (wanted + theta))
    return Gains(kc, kc * CONTROL_PERIOD_S / ti)


def closed_time_constant(model: DeadTimeModel, kp: float) -> float:
    """Return the wanted closed-loop time constant, s, at which the rule gives `kp`."""
    tau = model.slow_s + model.fast_s / 2.0
    return tau / (model.gain * kp) - (model.dead_s + model.fast_s / 2.0)
