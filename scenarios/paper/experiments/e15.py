"""E15: one pair of gains for both preloads."""

from scenarios.paper.experiments.experiment import Experiment, Figures, Limit
from scenarios.paper.measures import peak_percent
from scenarios.paper.starts import Benches

SPEEDS = (600.0, 1000.0, 7200.0)


def measure(benches: Benches) -> Figures:
    """Peaks at high preload with the controller of the low one."""
    assert benches.plants["low"].controller == benches.plants["high"].controller
    found = {}
    for speed in SPEEDS:
        log = benches("high").closed_loop(speed, 16.0).after(8.0)
        found[f"peak {speed:g}"] = peak_percent(log.rate, speed)
    return found


ROW = Experiment(
    "E15", "one controller for both preloads", "section 4", "same controller",
    "the effect of nonlinear friction dynamics can be reduced by reducing the preload on the drive bearings "
    "and the peak errors at fine speeds using a linear controller can be maintained within 25%.",
    "High preload with the same gains at 600, 1000 and 7200″/s, 8 s after 8 s: peak of the 5 ms counts ≤ 25 "
    "%, the paper's own bound for a linear controller; what high preload spoils are fine speeds (E2).",
    tuple(Limit(f"peak {v:g}", "%", 0.0, 25.0, f"peak at {v:g}″/s", 5.0) for v in SPEEDS),
    measure,
)  # fmt: skip
