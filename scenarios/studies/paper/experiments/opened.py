"""The loop opened, at 600 and 1000 arcsec/s and down to the slowest speed it keeps (E5, E6)."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import Array, Log, line_amplitude, peak_percent, stalled, strongest_line
from scenarios.studies.paper.runs import LOW, MOTOR_TURN_ARCSEC, OPENED, high_speed, low_speed
from scenarios.studies.paper.scales import LOG_PERIOD_S
from scenarios.studies.paper.starts import Benches

SECONDS, SETTLE, EDGE = 60.0, 4.0, 5.0
CORNER_HZ = 0.05
"""Slower errors are drifts: the speed that an open loop happens to settle at, and the balance of the axis."""
NAN = float("nan")


def fast_peak(rate: Array, setpoint: float) -> float:
    """Return the peak of a high-passed velocity, percent of the set point, `EDGE` s left out at both ends."""
    high = butter(2, CORNER_HZ, "highpass", fs=1.0 / LOG_PERIOD_S, output="sos")
    edge = round(EDGE / LOG_PERIOD_S)
    passed = sosfiltfilt(high, rate)[edge:-edge]
    return float(np.max(np.abs(passed)) / setpoint * 100.0)


@row("E5")
def higher_speeds(benches: Benches) -> Figures:
    """High-passed peaks in open and closed loop."""
    found: Figures = {}
    open_peak = closed_peak = 0.0
    for speed in OPENED:
        logs = high_speed(benches("low"), speed, SECONDS + 2 * EDGE, SETTLE)
        closed, opened = (fast_peak(log.rate, speed) for log in logs)
        found[f"peak {speed:g}"] = opened
        open_peak, closed_peak = max(open_peak, opened), max(closed_peak, closed)
    return found | {"closed": closed_peak, "ratio": open_peak / closed_peak}


@row("E6")
def slowest(benches: Benches) -> Figures:
    """The staircase of open-loop efforts and what the loop leaves of the slow line."""
    closed, running = low_speed(lambda: benches("low"))
    if not running:
        return {}
    nearest = min(running, key=lambda log: abs(log.rate.mean() - LOW))
    line = strongest_line(nearest.rate, 0.01, 0.2)
    mean = float(nearest.rate.mean())
    effort = round(float(np.median(nearest.effort)))
    step_up = benches("low")
    step_up.closed_loop(1.4 * LOW, 4.0)
    above = step_up.open_loop(effort + 1, 72.0).after(12.0)
    moving = not stalled(above.rate)
    return {
        "line": line.frequency_hz,
        "nearest": abs(mean - LOW),
        "lowest": min(float(log.rate.mean()) for log in running),
        "left": line_amplitude(closed.rate, line.frequency_hz) / max(1e-9, line.amplitude),
        "narrower": peak_percent(nearest.rate, mean) - peak_percent(closed.rate, LOW),
        "order a step up": order(above) / max(1e-9, order(nearest)) if moving else NAN,
        "mean": mean,
        "amplitude": line.amplitude,
        "speed a step up": float(above.rate.mean()),
    }


def order(log: Log) -> float:
    """Return the strongest slow line's cycles per motor turn."""
    mean = float(log.rate.mean())
    return strongest_line(log.rate, 0.01, 0.2).frequency_hz * MOTOR_TURN_ARCSEC / max(1.0, mean)
