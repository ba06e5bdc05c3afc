"""E1: tracking speed, low preload."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.measures import means, peak_percent
from scenarios.studies.paper.runs import TRACKING, tracking
from scenarios.studies.paper.starts import Benches

SECONDS = 240.0
"""One turn of the motor at 15 arcsec/s."""


def measure(benches: Benches) -> Figures:
    """Peak of the 5 ms counts over a motor turn; the true rate beside it."""
    log = tracking(benches("low"), SECONDS)
    return {
        "peak": peak_percent(log.rate, TRACKING),
        "true peak": peak_percent(log.true_rate, TRACKING),
        "true peak of 1 s means": peak_percent(means(log.true_rate), TRACKING),
        "true rms": float(np.std(log.true_rate)),
    }


ROW = row("E1", measure)
