"""E12: 600 to 1000 arcsec/s is the viscous branch."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import EVER, Experiment, Figures, Limit
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


ROW = Experiment(
    id="E12",
    limits=(
        Limit(figure="slope", unit="1", low=0.5, high=1.5, words="slope over σ2", scale=0.2),
        Limit(figure="rise", unit="%", low=0.0, high=EVER, words="rise of the torque", scale=2.0),
    ),
    measure=measure,
)  # fmt: skip
