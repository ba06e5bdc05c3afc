"""E2: tracking speed, high preload."""

from scenarios.studies.paper.bench import Bench
from scenarios.studies.paper.experiments.experiment import EVER, Experiment, Figures, Limit
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


ROW = Experiment(
    id="E2",
    limits=(
        Limit(figure="peak", unit="%", low=100.0, high=1000.0, words="peak of 5 ms counts", scale=300.0),
        Limit(figure="high", unit="1", low=3.0, high=EVER, words="stick-slip cycles", scale=2.0),
        Limit(figure="low", unit="1", low=0.0, high=0.0, words="cycles at low preload", scale=2.0),
        Limit(figure="viscous", unit="1", low=0.0, high=0.0, words="cycles without Coulomb friction",
            scale=2.0),
    ),
    measure=measure,
)  # fmt: skip
