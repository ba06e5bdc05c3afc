"""Friction and inertia as measured, the viscous branch, a motor at rest (E7, E8, E12, E14)."""

import numpy as np

from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.experiments.frictionmap import Noise, friction_map
from scenarios.studies.paper.friction_map import ripple_free, steady_point
from scenarios.studies.paper.rundown import fit_run_downs
from scenarios.studies.paper.runs import BROKEN_AWAY, HIGH, break_away, map_run, run_down
from scenarios.studies.paper.scales import EFFORT_SCALE, INERTIA, TABLE_2, drive
from scenarios.studies.paper.starts import Benches, with_inertia

REGION = (0.25, 3.0)  # Of vs: where the Stribeck effect does most of its falling.
OTHERS = (0.8, 1.2)  # Factors on the inertia.
RUN_DOWN_SPEEDS = (7200.0, 2400.0)  # arcsec/s: the slew speed of Table 1, and a third of it.
PLACES = (0.0, 0.25)
"""Motor turns: what its second harmonic adds to the torque at one of them it takes off at the other."""


@row("E7")
def table_2(benches: Benches) -> Figures:
    """Deviations of the fitted four from Table 2, percent, and how many points lie in the Stribeck region."""
    found: Figures = {}
    region = []
    noise = Noise(benches.start.seed, f"e7.{benches.start.angle_deg}")
    for preload, table in TABLE_2.items():
        friction = benches.plants[preload].axes.ra.friction
        unit = friction.coulomb.value / friction.coulomb.si  # N m to the unit in which Table 2 is read
        points, fit = friction_map(benches, preload, noise)
        low, high = (share * table["stribeck_rate"] for share in REGION)
        region.append(sum(low <= point.rate <= high for point in points))
        if fit is None:
            continue
        for name, printed in table.items():
            scale = unit if name in ("coulomb", "stiction") else 1.0
            value = float(getattr(fit, name)) * scale
            found[f"{preload} {name}"] = (value / printed - 1.0) * 100.0
        found[f"{preload} exponent"] = fit.exponent
    found["region"] = float(min(region))
    return found


@row("E8")
def inertia(benches: Benches) -> Figures:
    """Inertia of the plant and of two others, percent off what each has."""
    plant = benches.plants["low"]
    # an error of the torque constant is one of J, share for share: E7 has it
    noise = Noise(benches.start.seed, f"e8.{benches.start.angle_deg}", constant_error=0.0)
    _, fit = friction_map(benches, "low", noise)
    if fit is None:
        return {}
    sheet = drive(plant)
    runs = [(way * speed, turns) for speed in RUN_DOWN_SPEEDS for way in (1, -1) for turns in PLACES]
    setpoints = [setpoint for setpoint, _ in runs]
    found: Figures = {}
    for factor in (1.0, *OTHERS):
        model = plant if factor == 1.0 else with_inertia(plant, factor)
        logs = [noise.log(run_down(benches.of(model), *each)) for each in runs]
        measured = fit_run_downs(logs, setpoints, fit, sheet).inertia
        found[f"off {factor:g}"] = (measured / (factor * INERTIA) - 1.0) * 100.0
        found[f"J {factor:g}"] = measured
    return found


@row("E12")
def viscous_branch(benches: Benches) -> Figures:
    """Slope of the measured torque over 600 to 1000 arcsec/s, as a share of Table 2's viscous friction."""
    sheet = drive(benches.plants["low"])
    points = []
    for speed in HIGH:
        logs = [map_run(benches("low"), way * speed) for way in (1.0, -1.0)]
        points.append(steady_point(logs[0], logs[1], sheet))
    rate, torque = np.array([p.rate for p in points]), np.array([p.torque for p in points])
    slope = float(np.polyfit(rate, torque, 1)[0])
    return {"slope": slope / TABLE_2["low"]["viscous"], "rise": float(torque[-1] / torque[0] - 1.0) * 100.0}


@row("E14")
def at_rest(benches: Benches) -> Figures:
    """Stalled current at full duty, from the current of an effort that does not move the axis yet."""
    log = break_away(benches("high"), 1)
    gone = np.nonzero(np.abs(log.counts) > BROKEN_AWAY)[0]
    end = max(40, (int(gone[0]) if gone.size else log.t_s.size) - 20)
    held = slice(end - 40, end)
    current = ripple_free(log, drive(benches.plants["high"]))[0][held]
    duty = log.effort[held] / EFFORT_SCALE
    return {"stall": float(current @ duty / (duty @ duty)), "break-away current": float(current[-5:].mean())}
