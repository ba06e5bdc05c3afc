"""The torque-velocity map of one preload from noisy logs, and the characteristic fitted to it."""

from dataclasses import dataclass

import numpy as np

from scenarios.paper.experiments.noise import Noise
from scenarios.paper.friction_map import (
    FrictionFit,
    MapPoint,
    break_away_point,
    data_sheet,
    fit_friction,
    steady_point,
)
from scenarios.paper.log import Log
from scenarios.paper.measures import cycles, stalled
from scenarios.paper.runs import MAP_SPEEDS, break_away, map_run
from scenarios.paper.scales import ARCSEC
from scenarios.paper.starts import Benches

STEADY_RATE, STEADY_TORQUE = 0.05, 0.03
"""Shares: how far the mean velocity may be off the set point, and how uncertain the mean torque may be, for a
steady state."""


def steady(speed: float, point: MapPoint, logs: tuple[Log, Log]) -> bool:
    """Whether a run is a steady state. A limit cycle is none: its torque belongs to no velocity."""
    if any(stalled(log.rate) or cycles(np.abs(log.true_rate), speed) for log in logs):
        return False
    off = abs(point.rate / ARCSEC / speed - 1.0)
    return off < STEADY_RATE and point.spread < STEADY_TORQUE * point.torque


@dataclass(frozen=True)
class Map:
    """Points, the speeds that were no steady states, and the fit (None: too few points)."""

    points: list[MapPoint]
    left_out: list[float]
    fit: FrictionFit | None


def friction_map(benches: Benches, preload: str, noise: Noise) -> Map:
    """Measure the map: steady states in both directions, and the break-away torque as its point at rest."""
    sheet = noise.sheet(data_sheet(benches.plants[preload]))
    ways = [noise.log(break_away(benches(preload), way)) for way in (1, -1)]
    points = [break_away_point(ways[0], ways[1], sheet)]
    left_out = []
    for speed in MAP_SPEEDS:
        logs = [noise.log(map_run(benches(preload), way * speed)) for way in (1.0, -1.0)]
        point = steady_point(logs[0], logs[1], sheet)
        if steady(speed, point, (logs[0], logs[1])):
            points.append(point)
        else:
            left_out.append(speed)
    return Map(points, left_out, fit_friction(points) if len(points) >= 6 else None)
