"""E6: open loop at 100 arcsec/s, the slowest open-loop speed, and the loop closed."""

import numpy as np

from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.log import Log
from scenarios.paper.measures import line_amplitude, peak_percent, stalled, strongest_line
from scenarios.paper.runs import LOW, low_speed
from scenarios.paper.starts import Benches

TURN_ARCSEC = 1_296_000.0 / 360.489
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


ROW = Experiment(
    "E6", "100″/s, open against closed", "Fig. 7", "≈ 0.05 Hz",
    "in absence of a feedback control, the errors are quite high and some low frequency oscillations close "
    "to 0.05 Hz are riding on the velocity response whereas the feedback control filters out the low "
    "frequency errors and also reduces the error band. / in the open loop ... it is not possible to reach "
    "speeds below 100 arc sec/s.",
    "Low preload. Open loop, effort lowered in the smallest steps from 140″/s until the axis stays put: "
    "lowest speed kept up within 80–115″/s; the run nearest to 100″/s within 15″/s of it, its strongest line"
    " between 0.01 and 0.2 Hz within 0.04–0.06 Hz; closed loop at 100″/s leaves at most 30 % of that line "
    "and has the smaller peak error. One PWM step above, the axis runs too and its strongest line is the "
    "same order of the motor, within 15 %.",
    (
        Limit("lowest", "″/s", 80.0, 115.0, "lowest open-loop speed", 15.0),
        Limit("nearest", "″/s", 0.0, 15.0, "off 100″/s", 10.0),
        Limit("line", "Hz", 0.04, 0.06, "strongest slow line", 0.01),
        Limit("left", "1", 0.0, 0.3, "left of it by the loop", 0.1),
        Limit("narrower", "points", 0.0, EVER, "error band narrower by", 5.0),
        Limit("order a step up", "1", 0.85, 1.15, "line's order one step up", 0.1),
    ),
    measure,
    (("mean", "″/s"), ("amplitude", "″/s"), ("speed a step up", "″/s")),
)  # fmt: skip
