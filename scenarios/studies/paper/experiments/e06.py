"""E6: open loop at 100 arcsec/s, the slowest open-loop speed, and the loop closed."""

import numpy as np

from plant.units import ARCSEC_PER_TURN
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.log import Log
from scenarios.studies.paper.measures import line_amplitude, peak_percent, stalled, strongest_line
from scenarios.studies.paper.runs import LOW, low_speed
from scenarios.studies.paper.starts import Benches

TURN_ARCSEC = ARCSEC_PER_TURN / 360.489
"""arcsec of the axis in a motor turn."""
NAN = float("nan")


def order(log: Log) -> float:
    """Return the strongest slow line's cycles per motor turn."""
    mean = float(log.rate.mean())
    return strongest_line(log.rate, 0.01, 0.2).frequency_hz * TURN_ARCSEC / max(1.0, mean)


def measure(benches: Benches) -> Figures:
    """The staircase of open-loop efforts and what the loop leaves of the slow line."""
    run = low_speed(lambda: benches("low"))
    nearest, lowest = run.nearest, run.lowest
    if nearest is None or lowest is None:
        return {}
    line = strongest_line(nearest.rate, 0.01, 0.2)
    mean = float(nearest.rate.mean())
    effort = round(float(np.median(nearest.effort)))
    step_up = benches("low")
    step_up.closed_loop(1.4 * LOW, 4.0)
    above = step_up.open_loop(effort + 1, 72.0).after(12.0)
    moving = not stalled(above.rate)
    return {
        "line": line.frequency_hz,
        "nearest": abs(mean - LOW),
        "lowest": lowest,
        "left": line_amplitude(run.closed.rate, line.frequency_hz) / max(1e-9, line.amplitude),
        "narrower": peak_percent(nearest.rate, mean) - peak_percent(run.closed.rate, LOW),
        "order a step up": order(above) / max(1e-9, order(nearest)) if moving else NAN,
        "mean": mean,
        "amplitude": line.amplitude,
        "speed a step up": float(above.rate.mean()),
    }


ROW = row("E6", measure)
