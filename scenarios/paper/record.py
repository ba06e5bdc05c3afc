"""Logs and fits that the figures are drawn from, taken at one start."""

from dataclasses import dataclass, field

from scenarios.paper import runs
from scenarios.paper.coasting import Drive, drive
from scenarios.paper.experiments.e08 import SPEEDS
from scenarios.paper.experiments.e09 import RAMP_ARCSEC_S2
from scenarios.paper.experiments.frictionmap import friction_map
from scenarios.paper.experiments.noise import Noise
from scenarios.paper.friction_map import FrictionFit, MapPoint
from scenarios.paper.linear import linear_axis, simulate_loop
from scenarios.paper.log import Array, Log
from scenarios.paper.rundown import Inertia, fit_run_downs
from scenarios.paper.scales import LOG_PERIOD_S
from scenarios.paper.starts import Benches

OPENED_S = 60.0
PARTS = 8
"""Progress reports of `record`."""


@dataclass
class Record:
    """What the paper's figures show."""

    tracking: dict[str, Log] = field(default_factory=dict)
    high: list[runs.HighSpeed] = field(default_factory=list)
    slew: list[tuple[float, Log]] = field(default_factory=list)
    low: runs.LowSpeed | None = None
    points: dict[str, list[MapPoint]] = field(default_factory=dict)
    fits: dict[str, FrictionFit] = field(default_factory=dict)
    run_down: tuple[Log, Inertia] | None = None
    drive: Drive | None = None
    step: Log | None = None
    linear: tuple[Array, Array, Array] | None = None


def record(benches: Benches) -> Record:
    """Run what the figures need; what cannot be evaluated on these plants stays empty."""
    found = Record()
    for preload in ("low", "high"):
        found.tracking[preload] = runs.tracking(benches(preload))
    for speed in runs.HIGH:
        opened = OPENED_S if speed in runs.OPENED else 0.0
        found.high.append(runs.high_speed(benches("low"), speed, opened_s=opened))
    found.slew = [(speed, runs.slow_slew(benches("low"), speed)) for speed in runs.SLOW_SLEW]
    found.low = runs.low_speed(lambda: benches("low"))
    for preload in ("low", "high"):
        measured = friction_map(benches, preload, Noise(benches.start.seed, "figures"))
        found.points[preload] = measured.points
        if measured.fit is not None:
            found.fits[preload] = measured.fit
    plant = benches.plants["low"]
    found.drive = drive(plant)
    if "low" in found.fits:
        try:
            setpoints = [way * speed for speed in SPEEDS for way in (1, -1)]
            logs = [runs.run_down(benches("low"), setpoint) for setpoint in setpoints]
            found.run_down = logs[0], fit_run_downs(logs, setpoints, found.fits["low"], found.drive)
        except ValueError:
            found.run_down = None  # it was at rest at once: there is no figure 9
    found.step = log = runs.step(benches("low"), runs.STEP_TO)
    steps, seconds = round(plant.controller.pwm_steps.si), float(log.t_s.size * LOG_PERIOD_S)
    found.linear = simulate_loop(
        linear_axis(plant), benches.gains, steps, runs.STEP_TO, seconds, RAMP_ARCSEC_S2
    )
    return found
