"""E5: open loop at 600 and 1000 arcsec/s."""

import numpy as np
from scipy.signal import butter, sosfiltfilt

from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.log import Array
from scenarios.paper.runs import OPENED, high_speed
from scenarios.paper.scales import LOG_PERIOD_S
from scenarios.paper.starts import Benches

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
    over = []
    for speed in OPENED:
        run = high_speed(benches("low"), speed, SECONDS + 2 * EDGE, SETTLE, SECONDS + 2 * EDGE)
        assert run.opened is not None
        opened, closed = (fast_peak(log.rate, speed) for log in (run.opened, run.closed))
        found[f"peak {speed:g}"] = opened
        over.append(opened - closed)
    found["over"] = min(over)
    return found


ROW = Experiment(
    "E5", "open loop, 600–1000″/s", "Fig. 6(a)", "up to 15 % peak",
    "Without a feedback controller, the peak error reaches up to 15% and also limit cycles are more "
    "prominent whereas the feedback control improves the performance and limits the peak error close to 7%.",
    "Low preload, 600 and 1000″/s: the loop is opened at the mean effort it had needed. Velocity of the 5 ms"
    " counts above 0.05 Hz over 60 s: peak ≤ 15 % of the set point, and above that of the closed loop "
    "before.",
    (
        *(Limit(f"peak {v:g}", "%", 0.0, 15.0, f"peak at {v:g}″/s", 2.0) for v in OPENED),
        Limit("over", "points", 0.0, EVER, "points above the closed loop", 1.0),
    ),
    measure,
)  # fmt: skip
