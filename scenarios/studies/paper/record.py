"""Logs and fits that the figures are drawn from, taken at one start."""

from dataclasses import dataclass

from scenarios.studies.paper import runs
from scenarios.studies.paper.coasting import Coasting, Drive, drive
from scenarios.studies.paper.experiments.friction import RUN_DOWN_SPEEDS
from scenarios.studies.paper.experiments.frictionmap import friction_map
from scenarios.studies.paper.experiments.noise import Noise
from scenarios.studies.paper.friction_map import FrictionFit, MapPoint
from scenarios.studies.paper.linear import beside
from scenarios.studies.paper.log import Array, Log
from scenarios.studies.paper.rundown import fit_run_downs
from scenarios.studies.paper.starts import Benches

OPENED_S = 60.0


@dataclass(frozen=True, kw_only=True)
class Record:
    """What the paper's figures show; run_down: of the fastest run, and what all of them say together."""

    tracking: dict[str, Log]
    high: list[runs.HighSpeed]
    slew: list[tuple[float, Log]]
    low: runs.LowSpeed
    points: dict[str, list[MapPoint]]
    fits: dict[str, FrictionFit]
    run_down: tuple[Log, Coasting] | None
    drive: Drive
    step: Log
    linear: tuple[Array, Array, Array]


def record(benches: Benches) -> Record:
    """Run what the figures need; what cannot be evaluated on these plants stays empty."""
    maps = {
        preload: friction_map(benches, preload, Noise(benches.start.seed, "figures"))
        for preload in ("low", "high")
    }
    fits = {preload: found.fit for preload, found in maps.items() if found.fit is not None}
    step = runs.step(benches("low"), runs.STEP_TO)
    sheet = drive(benches.plants["low"])
    return Record(
        tracking={preload: runs.tracking(benches(preload)) for preload in ("low", "high")},
        high=[
            runs.high_speed(benches("low"), speed, opened_s=OPENED_S if speed in runs.OPENED else 0.0)
            for speed in runs.HIGH
        ],
        slew=[(speed, runs.slow_slew(benches("low"), speed)) for speed in runs.SLOW_SLEW],
        low=runs.low_speed(lambda: benches("low")),
        points={preload: found.points for preload, found in maps.items()},
        fits=fits,
        run_down=_run_down(benches, fits.get("low"), sheet),
        drive=sheet,
        step=step,
        linear=beside(benches, step),
    )


def _run_down(benches: Benches, friction: FrictionFit | None, sheet: Drive) -> tuple[Log, Coasting] | None:
    """None where it was at rest at once: then there is no figure 9."""
    if friction is None:
        return None
    setpoints = [way * speed for speed in RUN_DOWN_SPEEDS for way in (1, -1)]
    try:
        logs = [runs.run_down(benches("low"), setpoint) for setpoint in setpoints]
        return logs[0], fit_run_downs(logs, setpoints, friction, sheet)
    except ValueError:
        return None
