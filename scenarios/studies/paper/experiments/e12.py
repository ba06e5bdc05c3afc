"""E12: 600 to 1000 arcsec/s is the viscous branch."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.friction_map import data_sheet, steady_point
from scenarios.studies.paper.published import TABLE_2
from scenarios.studies.paper.runs import HIGH, map_run
from scenarios.studies.paper.starts import Benches


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


ROW = row("E12", measure)
