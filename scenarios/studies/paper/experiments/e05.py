"""E5: open loop at 600 and 1000 arcsec/s."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.log import Array
from scenarios.studies.paper.runs import OPENED, high_speed
from scenarios.studies.paper.scales import LOG_PERIOD_S
from scenarios.studies.paper.starts import Benches

SECONDS, SETTLE, EDGE = 60.0, 4.0, 5.0
CORNER_HZ = 0.05
"""Slower errors are drifts: the speed that an open loop happens to settle at, and the balance of the axis."""


def fast_peak(rate: Array, setpoint: float) -> float:
    """Return the peak of a high-passed velocity, percent of the set point, `EDGE` s left out at both ends."""
    high = butter(2, CORNER_HZ, "highpass", fs=1.0 / LOG_PERIOD_S, output="sos")
    edge = round(EDGE / LOG_PERIOD_S)
    passed = sosfiltfilt(high, rate)[edge:-edge]
    return float(np.max(np.abs(passed)) / setpoint * 100.0)


def measure(benches: Benches) -> Figures:
    """High-passed peaks in open and closed loop."""
    found: Figures = {}
    open_peak = closed_peak = 0.0
    for speed in OPENED:
        run = high_speed(benches("low"), speed, SECONDS + 2 * EDGE, SETTLE, SECONDS + 2 * EDGE)
        assert run.opened is not None
        opened, closed = (fast_peak(log.rate, speed) for log in (run.opened, run.closed))
        found[f"peak {speed:g}"] = opened
        open_peak, closed_peak = max(open_peak, opened), max(closed_peak, closed)
    return found | {"closed": closed_peak, "ratio": open_peak / closed_peak}


ROW = row("E5", measure)
