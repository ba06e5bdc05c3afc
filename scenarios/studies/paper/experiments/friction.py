"""Friction and inertia as measured, the viscous branch, a motor at rest (E7, E8, E12, E14)."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bus.time.randomness import generator
from scenarios.studies.paper.experiments.experiment import Figures, row
from scenarios.studies.paper.friction_map import (
    FrictionFit,
    MapPoint,
    break_away_point,
    fit_friction,
    ripple_free,
    steady_point,
)
from scenarios.studies.paper.measures import Array, Log, cycles, stalled
from scenarios.studies.paper.rundown import fit_run_downs
from scenarios.studies.paper.runs import (
    BROKEN_AWAY,
    HIGH,
    MAP_SPEEDS,
    break_away,
    map_pair,
    map_run,
    opened_pair,
    run_down,
)
from scenarios.studies.paper.scales import ARCSEC, EFFORT_SCALE, INERTIA, TABLE_2, Drive, drive
from scenarios.studies.paper.starts import Benches, with_inertia

ADC_NOISE = 1.0
"""Counts rms on every current sample: 6.1 mA of 6 A. ASSUMPTION: one count of ten bits beside a PWM."""
GAIN_NOISE = 0.01  # Share of the reading, rms, from sample to sample: brush noise. ASSUMPTION.
CONSTANT_ERROR = 0.05  # Share by which a motor's torque constant may be off its data sheet, either way.


class Noise:
    """Sensor noise by a seed, and one error of the torque constant, up to a share, for all its logs."""

    def __init__(self, seed: int, name: str, constant_error: float = CONSTANT_ERROR) -> None:
        self._random = generator(seed, f"paper.noise.{name}")
        self.constant = 1.0 + constant_error * (2.0 * float(self._random.random()) - 1.0)

    def log(self, log: Log) -> Log:
        """Return the log with noise on both currents, in whole counts."""

        def noisy(counts: Array) -> Array:
            drawn = self._random.standard_normal((2, counts.size))
            read = counts * (1.0 + GAIN_NOISE * drawn[0]) + ADC_NOISE * drawn[1]
            return np.asarray(np.clip(np.rint(read), 0, 1023), dtype=np.float64)

        return replace(log, adc_a=noisy(log.adc_a), adc_b=noisy(log.adc_b))

    def sheet(self, sheet: Drive) -> Drive:
        """Return a data sheet whose torque constant is not quite the motor's."""
        return replace(sheet, torque_constant=sheet.torque_constant * self.constant)


STEADY_RATE, STEADY_TORQUE = 0.05, 0.03
"""Shares, of a steady state: mean velocity off the set point, and uncertainty of the mean torque, at most."""
ADC_FULL = 1023.0  # Largest count of the 10-bit converter: 6.24 A.
BREAK_AWAYS = (0.15, 0.2, 0.3)
"""s that each effort lasts on the way to break-away. Three, because the rate at that moment, some 10
arcsec/s, is read in counts of 2.3. It is all that is known of the curve's steep end."""
TRIALS = 80  # Pairs of efforts tried at most.


def steady(speed: float, point: MapPoint, logs: tuple[Log, ...]) -> bool:
    """Whether a run is a steady state. A limit cycle is none: its torque belongs to no velocity."""
    if any(stalled(log.rate) or cycles(np.abs(log.rate), speed) for log in logs):
        return False
    off = abs(point.rate / ARCSEC / speed - 1.0)
    return off < STEADY_RATE and point.unrest < STEADY_TORQUE * point.torque


def friction_map(benches: Benches, preload: str, noise: Noise) -> tuple[list[MapPoint], FrictionFit | None]:
    """Measure the map: steady states both ways, and the break-away torques as its points near rest. Points,
    and the fit (None: too few of them)."""
    sheet = noise.sheet(drive(benches.plants[preload]))
    points = []
    for step_s in BREAK_AWAYS:
        ways = [noise.log(break_away(benches(preload), way, step_s)) for way in (1, -1)]
        points.append(break_away_point(ways[0], ways[1], sheet))
    leaps = False  # at some speed the loop had no steady state
    slowest: tuple[Log, Log] | None = None
    for speed in reversed(MAP_SPEEDS):
        bench = benches(preload)
        there, back = map_pair(bench, speed)
        logs = (noise.log(there), noise.log(back))
        point = steady_point(logs[0], logs[1], sheet)
        if max(np.max(current) for log in logs for current in (log.adc_a, log.adc_b)) >= ADC_FULL:
            continue
        if steady(speed, point, logs):
            points.append(point)
            slowest = slowest if leaps else logs
        else:
            leaps = True
    if leaps and slowest is not None:
        points += opened(benches, preload, noise, sheet, slowest)
    return points, fit_friction(points) if len(points) >= 6 else None


def opened(
    benches: Benches, preload: str, noise: Noise, sheet: Drive, begin: tuple[Log, Log]
) -> Iterator[MapPoint]:
    """Yield the steady states with the loop opened, one for every step of the effort, until one is none.

    Lowered is the effort there and the effort back in turn, so that a step of the map is half a step of the
    PWM. begin: there and back at the slowest speed that the loop holds. The efforts there and back keep the
    difference that the loop had needed between them: the balance of the axis pulls to one side.
    """
    speed = float(begin[0].rate.mean())
    efforts = [round(abs(float(log.effort.mean()))) for log in begin]
    for lower in range(1, min(TRIALS, 2 * min(efforts))):
        bench = benches(preload)
        there, back = opened_pair(bench, speed, efforts[0] - (lower + 1) // 2, lower // 2 - efforts[1])
        logs = (noise.log(there), noise.log(back))
        point = steady_point(logs[0], logs[1], sheet)
        if point.rate <= 0.0 or not steady(point.rate / ARCSEC, point, logs):
            return
        yield point


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
