"""E3: closed loop at 600 to 1000 arcsec/s, against the open loop at the same speed."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.log import Array
from scenarios.studies.paper.measures import peak_percent
from scenarios.studies.paper.runs import HIGH, high_speed
from scenarios.studies.paper.starts import Benches

SECONDS, SETTLE = 12.0, 4.0


def ripple(rate: Array) -> float:
    """Return the rms of a velocity record about its own straight line, in its unit."""
    t = np.arange(rate.size)
    return float(np.std(rate - np.polyval(np.polyfit(t, rate, 1), t)))


def measure(benches: Benches) -> Figures:
    """Peaks at all speeds, and the closed loop's ripple over the open loop's."""
    found: Figures = {}
    ratios = []
    for speed in HIGH:
        run = high_speed(benches("low"), speed, SECONDS, SETTLE, SECONDS)
        assert run.opened is not None
        found[f"peak {speed:g}"] = peak_percent(run.closed.rate, speed)
        ratios.append(ripple(run.closed.true_rate) / max(1e-9, ripple(run.opened.true_rate)))
    found["ripple"] = max(ratios)
    return found


ROW = row("E3", measure)
