"""E15: one pair of gains for both preloads."""

from scenarios.studies.paper.experiments.experiment import Experiment, Figures, Limit
from scenarios.studies.paper.measures import peak_percent
from scenarios.studies.paper.starts import Benches

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
    id="E15", title="one controller for both preloads", where="section 4", figure="same controller",
    quote="the effect of nonlinear friction dynamics can be reduced by reducing the preload on the drive "
    "bearings and the peak errors at fine speeds using a linear controller can be maintained within 25%.",
    bound="High preload with the same gains at three speeds, 8 s after 8 s. The limit is the paper's own "
    "bound for a linear controller. What high preload spoils are fine speeds (E2).",
    limits=tuple(
        Limit(figure=f"peak {v:g}", unit="%", low=0.0, high=25.0, words=f"peak at {v:g}″/s", scale=5.0)
        for v in SPEEDS
    ),
    measure=measure,
)  # fmt: skip
