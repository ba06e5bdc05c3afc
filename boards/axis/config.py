"""What is set when the axis board is programmed: gains, rates, limits. All integers as the firmware keeps
them."""

from dataclasses import dataclass, field
from typing import Final

from bus.protocol.scales import STEPS_PER_TURN, TICKS_PER_S, rate_q16
from bus.units import ARCSEC_PER_TURN

TICK_NS: Final = 5_000_000
"""Sampling time of the controller (paper, section 3.3)."""


def steps(arcsec: float) -> int:
    """An angle in arcsec as steps of the absolute encoder."""
    return round(arcsec * STEPS_PER_TURN / ARCSEC_PER_TURN)


def _classes() -> tuple[int, ...]:
    # Slew: Table 1, 12.583 rad/s at the motor. Track: sidereal. Set, guide and fine have no figures in the
    # paper:
    # ASSUMPTION, the speeds at which it shows results (600, 100 and 15 arcsec/s).
    return tuple(rate_q16(rate) for rate in (7200.0, 600.0, 100.0, 15.0, 15.041))


@dataclass(frozen=True, kw_only=True)
class AxisPeers:
    """Device types of the boards it listens to: its EnDat board, its motors, its auxiliary encoder's board
    (None: not on this network)."""

    position: int
    motor_a: int
    motor_b: int
    auxiliary: int | None = None


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisConfig:
    """Settings of one axis board.

    kp, ki: PWM steps per count/5 ms, and per count (ASSUMPTION; fitted to the paper's rows by plant file).
    counter_split: share of the effort the lagging motor gets, percent, 10..25 (paper, section 3.3).
    split_fade_counts: speed, counts/5 ms, at which that share has fallen to nothing. 0: it never falls
        (hardware.md 2.3: 25 % is not compatible with 24 V at slew for some motor constants).
    pwm_steps, pwm_hz: resolution and frequency of the motor PWM.
    position_gain: 1/s, of the position loop around the velocity loop (ASSUMPTION).
    kp_pointing, ki_pointing: gains of the velocity loop inside the position loop, and for stopping
        (ASSUMPTION: the paper has no position loop).
    ki_creep: instead of ki_pointing while the reference creeps. Below `creep_rate` (Q16 counts/5 ms) the
        bearings' bristles make the axis a spring, which wants, and bears, more integral action than a
        sliding mass.
    kp_gust, ki_gust: instead of kp_pointing and ki_creep while parameter 41 is set and wind shakes the axis
        (gusts.py).
    correction: largest rate the position loop adds, Q16 counts/5 ms.
    lag_steps: following error at which the profile waits for the axis.
    acceleration: Q16 counts/5 ms per 5 ms (Table 1: 12.583 rad/s2 at the motor = 2 deg/s2).
    classes: rates of slew, set, guide, fine, track, Q16 counts/5 ms.
    low, high: soft limits, steps. settle_steps: distance to the target that counts as settled.
    frame_ns: time a full frame takes on the bus, for the age of received measurements.
    """

    kp: float = 3.4
    ki: float = 0.037
    counter_split: int = 10
    split_fade_counts: int = 0
    pwm_steps: int = 3000
    pwm_hz: int = 20_000
    position_gain: float = 6.0
    kp_pointing: float = 1.0
    ki_pointing: float = 0.08
    ki_creep: float = 0.15
    kp_gust: float = 1.5
    ki_gust: float = 0.075
    creep_rate: int = rate_q16(200.0)
    correction: int = rate_q16(1500.0)
    lag_steps: int = steps(900.0)
    acceleration: int = rate_q16(7200.0) // TICKS_PER_S
    classes: tuple[int, ...] = field(default_factory=_classes)
    low: int = 0
    high: int = STEPS_PER_TURN - 1
    settle_steps: int = steps(5.0)
    frame_ns: int = 120_000
