"""E13: negligible rms at all velocities."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.log import Array
from scenarios.studies.paper.measures import means
from scenarios.studies.paper.runs import HIGH, LOW, SLOW_SLEW, TRACKING
from scenarios.studies.paper.starts import Benches

SPEEDS = (TRACKING, LOW, *HIGH, *SLOW_SLEW)
OBJECTIVE = 1.0
"""arcsec/s: the paper's objective for velocity."""
SHARE = 0.01
"""Of the set point: the paper's "within 1%"."""


def allowed(speed: float) -> float:
    """Return what is negligible at a speed, arcsec/s."""
    return max(OBJECTIVE, SHARE * speed)


def rms(error: Array) -> float:
    """Return the root mean square."""
    return float(np.sqrt(np.mean(error**2)))


def measure(benches: Benches) -> Figures:
    """Rms error of the true rate over what is negligible, at every speed: of one-second means, and raw."""
    found, raw = {}, {}
    for speed in SPEEDS:
        settle = 25.0 if speed < LOW else 8.0
        log = benches("low").closed_loop(speed, settle + 12.0).after(settle)
        found[f"at {speed:g}"] = rms(means(log.true_rate) - speed) / allowed(speed)
        raw[f"raw {speed:g}"] = rms(log.true_rate - speed) / allowed(speed)
    return {"worst": max(found.values()), "worst raw": max(raw.values())} | found | raw


ROW = row(
    "E13",
    measure,
    beside=tuple((f"{of} {speed:g}", "of the allowed") for of in ("at", "raw") for speed in SPEEDS),
)
