"""Tracking at 15 arcsec/s: both preloads, and gains that are too low (E1, E2, E11)."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import Log, means, peak_percent
from scenarios.studies.paper.runs import TRACKING, Bench, tracking
from scenarios.studies.paper.scales import COUNT_RATE, LOG_PERIOD_S
from scenarios.studies.paper.starts import Benches, viscous_only

MOTOR_TURN_S = 240.0
"""One turn of the motor at 15 arcsec/s."""
STICK_S = 0.1
"""s: shorter standstills are not called a stick phase. ASSUMPTION."""
STILL = COUNT_RATE / 2.0
"""arcsec/s: half the velocity quantum; a slower axis reads zero more often than not."""
LEAP = 2.0
"""Set points: an error of 100 %."""
LEAP_OF_LOW_GAINS = 1.5
FACTORS = (0.5, 0.25, 0.1)
"""Of the plant file's gains."""


@row("E1")
def low_preload(benches: Benches) -> Figures:
    """Peak of the 5 ms counts over a motor turn; the true rate beside it."""
    log = tracking(benches("low"), MOTOR_TURN_S)
    return {
        "peak": peak_percent(log.rate, TRACKING),
        "true peak": peak_percent(log.true_rate, TRACKING),
        "true peak of 1 s means": peak_percent(means(log.true_rate), TRACKING),
        "true rms": float(np.std(log.true_rate)),
    }


@row("E2")
def high_preload(benches: Benches) -> Figures:
    """Stick and slip at high preload, and none where there should be none."""

    def cycles(bench: Bench) -> tuple[int, float]:
        log = tracking(bench, 60.0)
        return stick_slips(log, TRACKING, LEAP), peak_percent(log.rate, TRACKING)

    high, peak = cycles(benches("high"))
    return {
        "peak": peak,
        "high": float(high),
        "low": float(cycles(benches("low"))[0]),
        "viscous": float(cycles(benches.of(viscous_only(benches.plants["high"])))[0]),
    }


@row("E11", tuple((f"at {factor:g}", "cycles") for factor in FACTORS))
def low_gains(benches: Benches) -> Figures:
    """Cycles with lowered gains, less those that the same axis shows without Coulomb friction. Gears alone
    can push a loop that is weak enough through zero and beyond, which is no stick-slip."""
    kp, ki = benches.gains
    smooth = viscous_only(benches.plants["low"])

    def cycles(bench: Bench) -> int:
        return stick_slips(tracking(bench, 120.0, 40.0), TRACKING, LEAP_OF_LOW_GAINS)

    found = {}
    for factor in FACTORS:
        gains = (kp * factor, ki * factor)
        found[f"at {factor:g}"] = float(cycles(benches("low", gains)) - cycles(benches.of(smooth, gains)))
    return {"most": max(found.values()), "own": float(cycles(benches("low")))} | found


def stick_slips(log: Log, setpoint: float, leap: float) -> int:
    """Return how often a stick phase (mean of 0.1 s within half a count of zero) was followed by a velocity
    above `leap` set points."""
    width = round(STICK_S / LOG_PERIOD_S)
    mean = np.convolve(log.rate, np.full(width, 1.0 / width), mode="valid")
    still = np.concatenate([np.abs(mean) < STILL, np.zeros(width - 1, dtype=bool)])
    fast = log.rate > leap * setpoint
    count, stuck = 0, False
    for at_rest, leaps in zip(still, fast, strict=True):
        if leaps:
            count += stuck
            stuck = False
        elif at_rest:
            stuck = True
    return count
