"""The axis board (dsPIC30F3011 at 30 MIPS) before it runs: interrupt table, pins, what it is programmed with.

Gains, rates and limits are integers as the firmware keeps them.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Final

from boards.axis.pi import GAIN_SHIFT
from boards.core import Source
from bus.protocol.scales import STEPS_PER_TURN, TICKS_PER_S, rate_q16
from bus.units import ARCSEC_PER_TURN

FCY_HZ: Final = 30_000_000
TICK_NS: Final = 5_000_000
"""Sampling time of the controller (paper, section 3.3)."""
TABLE: Final = (
    Source(
        "control", priority=6, latency_cycles=9, cost_cycles=1200
    ),  # 40 us: QEI, PI (32-bit errors, 64-bit products), PWM, SPI load of a frame
    Source(
        "can", priority=4, latency_cycles=9, cost_cycles=900, level=True
    ),  # 30 us: SPI read, dispatch, SPI load
)
"""Cycles are ASSUMPTIONS, estimated from instruction counts. The PWM-triggered ADC and the UART FIFO take
theirs inside these figures: 20 000 ADC interrupts a second would add nothing to the last conversion."""
PWM_ROUTINE: Final = Source("pwm", priority=7, latency_cycles=5, cost_cycles=20)
"""Only with the spread duty: per channel load, add, load, add with carry, store (10 cycles for two), flag,
shadow registers, return. Every PWM period, 1.7 % of the processor's time."""
HARMONIC_CYCLES: Final = 120
"""Per line of the compensation: its three long words, count and branch (6 + 1 + 3). The phase is a product of
32 x 29 bits (45). A table with two interpolations (30), two products and sums (35)."""
FRICTION_CYCLES: Final = 60
"""The friction model: two 32-bit products, sums."""
SHARE_CYCLES: Final = 75
"""With the spread duty: effort times share (15), division by 100 in two steps (40), low-pass (20)."""
BIAS_CYCLES: Final = 10
"""Added to both duties."""
LOCK_CYCLES: Final = 140
"""Sum and its limit in 64 bits (30), product with the gain (25). Of the gusts: two low-passes, sum and window
(65), choice of gains (20)."""
OBSERVER_CYCLES: Final = 900
"""25 products of 32 bits (625), sums, shifts and limits of four sections (200), angle and rate (75)."""
BLEND_CYCLES: Final = 100
"""Two sums of 64 bits (20), a shift by up to 15 places, one at a time (80)."""


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisPins:
    """encoder: quadrature inputs, (t_ns) -> counts. drive: gates of the two MOSFETs, (t_ns, duty_a,
    duty_b).

    current: ADC inputs behind the sense amplifiers, (t_ns, motor 0 or 1) -> A.
    """

    encoder: Callable[[int], int]
    drive: Callable[[int, float, float], None]
    current: Callable[[int, int], float]


def steps(arcsec: float) -> int:
    """An angle in arcsec as steps of the absolute encoder."""
    return round(arcsec * STEPS_PER_TURN / ARCSEC_PER_TURN)


def _classes() -> tuple[int, ...]:
    # Slew: Table 1, 12.583 rad/s at the motor. Track: sidereal. Set, guide and fine have no figures in the
    # paper: ASSUMPTION, the speeds at which it shows results (600, 100 and 15 arcsec/s).
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
        (hold.py).
    correction: largest rate the position loop adds, Q16 counts/5 ms.
    lag_steps: following error at which the profile waits for the axis.
    acceleration: Q16 counts/5 ms per 5 ms (Table 1: 12.583 rad/s2 at the motor = 2 deg/s2).
    classes: rates of slew, set, guide, fine, track, Q16 counts/5 ms.
    low, high: soft limits, steps. settle_steps: distance to the target that counts as settled.
    frame_ns: time a full frame takes on the bus, for the age of received measurements.
    """

    kp: float
    ki: float
    counter_split: int
    split_fade_counts: int = 0
    pwm_steps: int
    pwm_hz: int
    position_gain: float = 6.0
    kp_pointing: float
    ki_pointing: float
    ki_creep: float
    kp_gust: float
    ki_gust: float
    creep_rate: int = rate_q16(200.0)
    correction: int = rate_q16(1500.0)
    lag_steps: int = steps(900.0)
    acceleration: int = rate_q16(7200.0) // TICKS_PER_S
    classes: tuple[int, ...] = field(default_factory=_classes)
    low: int
    high: int
    settle_steps: int = steps(5.0)
    frame_ns: int


def settings(config: AxisConfig, peers: AxisPeers) -> tuple[int, ...]:
    """Parameters 1 to 11 first, then what no command changes; gains in Q12, the position loop's in Q16."""
    gains = (config.kp, config.ki, config.kp_pointing, config.ki_pointing, config.ki_creep)
    gusts = (config.kp_gust, config.ki_gust)
    kp, ki, *pointing = (round(gain * (1 << GAIN_SHIFT)) for gain in (*gains, *gusts))
    parameters = (config.counter_split, kp, ki, config.low, config.high, config.acceleration, *config.classes)
    return (
        *parameters,
        *pointing,
        config.split_fade_counts,
        config.pwm_steps,
        round(config.position_gain / TICKS_PER_S * 65536),
        config.correction,
        config.creep_rate,
        config.lag_steps,
        config.settle_steps,
        config.frame_ns,
        *(peers.position, peers.motor_a, peers.motor_b, peers.auxiliary or 0),
    )
