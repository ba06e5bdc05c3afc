"""The loop closed, from 600 arcsec/s to 3 deg/s, and its rms error at all velocities (E3, E4, E13, E15)."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import Array, means, peak_percent
from scenarios.studies.paper.runs import HIGH, LOW, SLOW_SLEW, TRACKING, high_speed, slow_slew
from scenarios.studies.paper.starts import Benches

SECONDS, SETTLE = 12.0, 4.0
"""s of E3."""
ALL_SPEEDS = (TRACKING, LOW, *HIGH, *SLOW_SLEW)
BOTH_PRELOADS = (600.0, 1000.0, 7200.0)
"""arcsec/s, of E15."""
OBJECTIVE = 1.0
"""arcsec/s: the paper's objective for velocity."""
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
    return {
        f"peak {speed / 3600:g}": peak_percent(slow_slew(benches("low"), speed).rate, speed)
        for speed in SLOW_SLEW
    }


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
