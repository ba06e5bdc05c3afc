"""E12: 600 to 1000 arcsec/s is the viscous branch."""

import numpy as np

from scenarios.paper.experiments.experiment import EVER, Experiment, Figures, Limit
from scenarios.paper.friction_map import data_sheet, steady_point
from scenarios.paper.published import TABLE_2
from scenarios.paper.runs import HIGH, map_run
from scenarios.paper.starts import Benches


def measure(benches: Benches) -> Figures:
    """Slope of the measured torque over 600 to 1000 arcsec/s, as a share of Table 2's viscous friction."""
    sheet = data_sheet(benches.plants["low"])
    points = []
    for speed in HIGH:
        logs = [map_run(benches("low"), way * speed) for way in (1.0, -1.0)]
        points.append(steady_point(logs[0], logs[1], sheet))
    rate, torque = np.array([p.rate for p in points]), np.array([p.torque for p in points])
    slope = float(np.polyfit(rate, torque, 1)[0])
    return {"slope": slope / TABLE_2["low"]["viscous"], "rise": float(torque[-1] / torque[0] - 1.0) * 100.0}


ROW = Experiment(
    "E12", "viscous branch", "section 4", "linear viscous regime",
    "At higher speeds of 600 to 1000 arc sec/s, the peak errors are within the 2% to 7% range as the the "
    "telescope operates in the linear viscous friction regime.",
    "Low preload, torque from currents at 600, 700, 800, 900 and 1000″/s, both ways: it rises from end to "
    "end, and the slope of a straight line is within a half and one and a half times Table 2's σ2.",
    (
        Limit("slope", "1", 0.5, 1.5, "slope over σ2", 0.2),
        Limit("rise", "%", 0.0, EVER, "rise of the torque", 2.0),
    ),
    measure,
)  # fmt: skip
