"""The torque-velocity map of one preload from noisy logs, and the characteristic fitted to it.

Steady states in closed loop where the loop holds them. Below the slowest of these the loop may leap instead:
there the loop is opened (as the authors did for Figs. 6 and 7) and the effort lowered in the smallest steps,
until the axis no longer keeps its speed. There and back go over the same stretch, because the balance of the
axis changes along it. Runs whose currents reach the end of the converter are left out: what it reads there is
not the current. The logs have noise of the instruments the authors read, which the firmware does not see.
"""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bus.time.randomness import generator
from scenarios.studies.paper.friction_map import (
    FrictionFit,
    MapPoint,
    break_away_point,
    fit_friction,
    steady_point,
)
from scenarios.studies.paper.measures import Array, Log, cycles, stalled
from scenarios.studies.paper.runs import MAP_SPEEDS, break_away, map_pair, opened_pair
from scenarios.studies.paper.scales import ARCSEC, Drive, drive
from scenarios.studies.paper.starts import Benches

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
