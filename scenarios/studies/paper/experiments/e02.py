"""E2: tracking speed, high preload."""

from scenarios.studies.paper.bench import Bench
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.stickslip import stick_slips
from scenarios.studies.paper.measures import peak_percent
from scenarios.studies.paper.runs import TRACKING, tracking
from scenarios.studies.paper.starts import Benches, viscous_only

LEAP = 2.0
"""Set points: an error of 100 %."""


def cycles(bench: Bench) -> tuple[int, float]:
    """Return (stick phases followed by a leap in 60 s, peak error in percent)."""
    log = tracking(bench, 60.0)
    return stick_slips(log, TRACKING, LEAP), peak_percent(log.rate, TRACKING)


def measure(benches: Benches) -> Figures:
    """Stick and slip at high preload, and none where there should be none."""
    high, peak = cycles(benches("high"))
    return {
        "peak": peak,
        "high": float(high),
        "low": float(cycles(benches("low"))[0]),
        "viscous": float(cycles(benches.of(viscous_only(benches.plants["high"])))[0]),
    }


ROW = row("E2", measure)
