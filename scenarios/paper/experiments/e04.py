"""E4: closed loop at 1 to 3 deg/s."""

from scenarios.paper.experiments.experiment import Experiment, Figures, Limit
from scenarios.paper.measures import peak_percent
from scenarios.paper.runs import SLOW_SLEW, slow_slew
from scenarios.paper.starts import Benches


def measure(benches: Benches) -> Figures:
    """Peaks at 1, 2 and 3 deg/s."""
    return {
        f"peak {speed / 3600:g}": peak_percent(slow_slew(benches("low"), speed).rate, speed)
        for speed in SLOW_SLEW
    }


ROW = Experiment(
    "E4", "closed loop, 1–3°/s", "Fig. 12", "< 1 % peak",
    "the peak errors are within 1% at slow speeds in the range of 1 to 3 deg/s.",
    "Low preload, closed loop at 1, 2 and 3°/s, 6 s after 7 s: the peak of the logged 5 ms counts is ≤ 1 % "
    "at each.",
    tuple(Limit(f"peak {v / 3600:g}", "%", 0.0, 1.0, f"peak at {v / 3600:g}°/s", 0.3) for v in SLOW_SLEW),
    measure,
)  # fmt: skip
