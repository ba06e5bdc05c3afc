"""The loop closed: tracking (E1, E2, E11), higher speeds, slews (E3, E4, E15), rms at all of them (E13)."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import Array, Log, means, peak_percent, rises
from scenarios.studies.paper.runs import HIGH, LOW, SLOW_SLEW, TRACKING, Bench, high_speed, tracking
from scenarios.studies.paper.scales import COUNT_RATE, LOG_PERIOD_S
from scenarios.studies.paper.starts import Benches, viscous_only

SECONDS, SETTLE = 12.0, 4.0
"""s of E3."""
SLEW_SECONDS, SLEW_SETTLE = 6.0, 7.0
"""s of E4, after the acceleration."""
ALL_SPEEDS = (TRACKING, LOW, *HIGH, *SLOW_SLEW)
BOTH_PRELOADS = (600.0, 1000.0, 7200.0)  # arcsec/s, of E15.
OBJECTIVE = 1.0  # arcsec/s: the paper's objective for velocity.
SHARE = 0.01
"""Of the set point: the paper's "within 1%"."""


def ripple(rate: Array) -> float:
    """Return the rms of a velocity record about its own straight line, in its unit."""
    t = np.arange(rate.size)
    return float(np.std(rate - np.polyval(np.polyfit(t, rate, 1), t)))


@row("E3")
def higher_speeds(benches: Benches) -> Figures:
    """Peaks at all speeds, and the closed loop's ripple over the open loop's."""
    found: Figures = {}
    ratios = []
    for speed in HIGH:
        closed, opened = high_speed(benches("low"), speed, SECONDS, SETTLE)
        found[f"peak {speed:g}"] = peak_percent(closed.rate, speed)
        ratios.append(ripple(closed.true_rate) / max(1e-9, ripple(opened.true_rate)))
    found["ripple"] = max(ratios)
    return found


@row("E4")
def slow_slews(benches: Benches) -> Figures:
    """Peaks at 1, 2 and 3 deg/s."""
    found: Figures = {}
    for speed in SLOW_SLEW:
        log = benches("low").closed_loop(speed, SLEW_SETTLE + SLEW_SECONDS).after(SLEW_SETTLE)
        found[f"peak {speed / 3600:g}"] = peak_percent(log.rate, speed)
    return found


@row("E13", tuple((f"{of} {speed:g}", "of the allowed") for of in ("at", "raw") for speed in ALL_SPEEDS))
def negligible(benches: Benches) -> Figures:
    """Rms error of the true rate over what is negligible, at every speed: of one-second means, and raw."""
    found, raw = {}, {}
    for speed in ALL_SPEEDS:
        settle, allowed = 25.0 if speed < LOW else 8.0, max(OBJECTIVE, SHARE * speed)
        log = benches("low").closed_loop(speed, settle + 12.0).after(settle)
        found[f"at {speed:g}"] = rms(means(log.true_rate) - speed) / allowed
        raw[f"raw {speed:g}"] = rms(log.true_rate - speed) / allowed
    return {"worst": max(found.values()), "worst raw": max(raw.values())} | found | raw


def rms(error: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(error**2)))


@row("E15")
def both_preloads(benches: Benches) -> Figures:
    """Peaks at high preload with the controller of the low one."""
    assert benches.plants["low"].controller == benches.plants["high"].controller
    found = {}
    for speed in BOTH_PRELOADS:
        log = benches("high").closed_loop(speed, 16.0).after(8.0)
        found[f"peak {speed:g}"] = peak_percent(log.rate, speed)
    return found


MOTOR_TURN_S = 240.0  # One turn of the motor at 15 arcsec/s.
STICK_S = 0.1  # s: shorter standstills are not called a stick phase. ASSUMPTION.
STILL = COUNT_RATE / 2.0  # arcsec/s: half the velocity quantum; a slower axis reads zero more often than not.
LEAP = 2.0  # Set points: an error of 100 %.
LEAP_OF_LOW_GAINS = 1.5
FACTORS = (0.5, 0.25, 0.1)  # Of the plant file's gains.


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
    return rises(still, log.rate > leap * setpoint)
