"""E2: tracking speed, high preload."""

from scenarios.paper.bench import Bench
from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.experiments.stickslip import stick_slips
from scenarios.paper.measures import peak_percent
from scenarios.paper.runs import TRACKING, tracking
from scenarios.paper.starts import Benches, viscous_only

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
    "E2", "15″/s, high preload", "Fig. 13(a)", "very high, limit cycles",
    "During excessive preload, the peak errors introduced by the jitters at tracking speeds under PI control"
    " are very high. / Near the tracking speeds, the limit cycles exhibited by nonlinear friction dynamics "
    "become more prominent and results in a jittery motion.",
    "High preload, same controller, 60 s after 25 s: at least three stick phases (0.1 s within half a count "
    "of zero), each followed by an error above 100 %; the peak not above 1000 %, because a jitter that "
    "outruns the Stribeck velocity (144″/s, Table 2) has left the friction that makes it. The same measure "
    "finds none at low preload and none with viscous friction only.",
    (
        Limit("peak", "%", 100.0, 1000.0, "peak of 5 ms counts", 300.0),
        Limit("high", "1", 3.0, EVER, "stick-slip cycles", 2.0),
        Limit("low", "1", 0.0, 0.0, "cycles at low preload", 2.0),
        Limit("viscous", "1", 0.0, 0.0, "cycles without Coulomb friction", 2.0),
    ),
    measure,
)  # fmt: skip
