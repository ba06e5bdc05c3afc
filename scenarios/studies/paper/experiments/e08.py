"""E8: run-down and moment of inertia."""

from scenarios.studies.paper.coasting import drive
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.frictionmap import friction_map
from scenarios.studies.paper.experiments.noise import Noise
from scenarios.studies.paper.published import INERTIA
from scenarios.studies.paper.rundown import fit_run_downs
from scenarios.studies.paper.runs import run_down
from scenarios.studies.paper.starts import Benches, with_inertia

OTHERS = (0.8, 1.2)
SPEEDS = (7200.0, 2400.0)
"""arcsec/s: the slew speed of Table 1, and a third of it."""


def measure(benches: Benches) -> Figures:
    """Inertia of the plant and of two others, percent off what each has."""
    plant = benches.plants["low"]
    # an error of the torque constant is one of J, share for share: E7 has it
    noise = Noise(benches.start.seed, f"e8.{benches.start.angle_deg}", constant_error=0.0)
    fit = friction_map(benches, "low", noise).fit
    if fit is None:
        return {}
    sheet = drive(plant)
    setpoints = [way * speed for speed in SPEEDS for way in (1, -1)]
    found: Figures = {}
    for factor in (1.0, *OTHERS):
        model = plant if factor == 1.0 else with_inertia(plant, factor)
        logs = [noise.log(run_down(benches.of(model), setpoint)) for setpoint in setpoints]
        inertia = fit_run_downs(logs, setpoints, fit, sheet).inertia
        found[f"off {factor:g}"] = (inertia / (factor * INERTIA) - 1.0) * 100.0
        found[f"J {factor:g}"] = inertia
    return found


ROW = row("E8", measure)
