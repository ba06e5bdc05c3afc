"""E3: closed loop at 600 to 1000 arcsec/s, against the open loop at the same speed."""

import numpy as np

from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.log import Array
from scenarios.paper.measures import peak_percent
from scenarios.paper.runs import HIGH, high_speed
from scenarios.paper.starts import Benches

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


ROW = Experiment(
    "E3", "closed loop, 600–1000″/s", "Figs. 6(b), 12", "2–7 % peak",
    "At higher speeds of 600 to 1000 arc sec/s, the peak errors are within the 2% to 7% range. / the "
    "feedback control improves the performance and limits the peak error close to 7%.",
    "Low preload, closed loop at 600, 700, 800, 900 and 1000″/s, 12 s after 4 s: the peak of the 5 ms counts"
    " within 1.5–7 % at every speed; and the feedback improves: rms of the true rate about its trend not "
    "above that of the open loop at the same speed, 12 s at the mean effort that the loop had needed.",
    (
        *(Limit(f"peak {v:g}", "%", 1.5, 7.0, f"peak at {v:g}″/s", 1.0) for v in HIGH),
        Limit("ripple", "1", -EVER, 1.0, "ripple, closed over open", 0.3),
    ),
    measure,
)  # fmt: skip
