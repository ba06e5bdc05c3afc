"""All ten experiments, in order, on benches of both preloads: logs, rows, and what the figures need."""

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from plant.parts import PlantModel
from scenarios.paper import judge_loop, judge_models, runs
from scenarios.paper.bench import BenchMaker
from scenarios.paper.friction_map import (
    DataSheet,
    FrictionFit,
    MapPoint,
    break_away_point,
    data_sheet,
    fit_friction,
    steady_point,
)
from scenarios.paper.linear import linear_axis, reduce_to_dead_time, simulate_loop
from scenarios.paper.log import Array, Log
from scenarios.paper.measures import cycles, stalled, step_response
from scenarios.paper.rows import Row
from scenarios.paper.rundown import RunDown, fit_inertia
from scenarios.paper.scales import ARCSEC, LOG_PERIOD_S

RAMP_ARCSEC_S2 = 7200.0
"""The firmware's acceleration limit, 2 deg/s2 (Table 1)."""

STEADY_RATE, STEADY_TORQUE = 0.05, 0.03
"""Shares: how far the mean velocity may be off the set point, and how uncertain the mean torque may be, for a
steady state."""

Progress = Callable[[str], None]


def steady(speed: float, point: MapPoint, logs: tuple[Log, Log]) -> bool:
    """Whether a run is a steady state. A limit cycle is none: its torque belongs to no velocity."""
    if any(stalled(log.rate) or cycles(np.abs(log.true_rate), speed) for log in logs):
        return False
    off = abs(point.rate / ARCSEC / speed - 1.0)
    return off < STEADY_RATE and point.spread < STEADY_TORQUE * point.torque


@dataclass
class Record:
    """Logs and fits that the figures are drawn from; filled as the campaign goes on."""

    tracking: dict[str, Log] = field(default_factory=dict)
    high: list[runs.HighSpeed] = field(default_factory=list)
    slew: list[tuple[float, Log]] = field(default_factory=list)
    low: runs.LowSpeed | None = None
    points: dict[str, list[MapPoint]] = field(default_factory=dict)
    left_out: dict[str, list[float]] = field(default_factory=dict)
    fits: dict[str, FrictionFit] = field(default_factory=dict)
    run_down: RunDown | None = None
    step: Log | None = None
    linear: tuple[Array, Array, Array] | None = None


class Campaign:
    """Runs the experiments on benches made by `bench`; `plants` are the models behind them, by preload."""

    def __init__(self, bench: BenchMaker, plants: dict[str, PlantModel], progress: Progress) -> None:
        self.bench = bench
        self.plants = plants
        self.progress = progress
        self.record = Record()

    def rows(self) -> list[Row]:
        """Return all ten rows."""
        steps: tuple[tuple[Callable[[], list[Row]], tuple[str, ...]], ...] = (
            (self._tracking, ("E1", "E2")),
            (self._high, ("E3", "E5")),
            (self._slew, ("E4",)),
            (self._low, ("E6",)),
            (self._friction, ("E7",)),
            (self._inertia, ("E8",)),
            (self._linear, ("E9",)),
            (self._tuning, ("E10",)),
        )
        found: list[Row] = []
        for step, names in steps:
            try:
                found += step()
            except ValueError as error:  # a plant on which an experiment cannot be evaluated misses its rows
                found += [Row(name, 0.0, False, f"MISS: could not be evaluated: {error}") for name in names]
        return sorted(found, key=lambda row: int(row.id[1:]))

    def _tracking(self) -> list[Row]:
        for preload in ("low", "high"):
            self.progress(f"15″/s, {preload} preload")
            self.record.tracking[preload] = runs.tracking(self.bench(preload))
        return [judge_loop.e1(self.record.tracking["low"]), judge_loop.e2(self.record.tracking["high"])]

    def _high(self) -> list[Row]:
        for speed in runs.HIGH:
            self.progress(f"{speed:g}″/s, closed loop" + (" and open loop" if speed in runs.OPENED else ""))
            opened = runs.OPENED_S if speed in runs.OPENED else 0.0
            self.record.high.append(runs.high_speed(self.bench("low"), speed, opened_s=opened))
        return [judge_loop.e3(self.record.high), judge_loop.e5(self.record.high)]

    def _slew(self) -> list[Row]:
        for speed in runs.SLOW_SLEW:
            self.progress(f"{speed / 3600:g}°/s")
            self.record.slew.append((speed, runs.slow_slew(self.bench("low"), speed)))
        return [judge_loop.e4(self.record.slew)]

    def _low(self) -> list[Row]:
        self.progress("100″/s, closed and open loop")
        self.record.low = runs.low_speed(lambda: self.bench("low"))
        return [judge_loop.e6(self.record.low)]

    def _friction(self) -> list[Row]:
        for preload, plant in self.plants.items():
            self._map(preload, data_sheet(plant))
        return [judge_models.e7(self.record.fits, self._table_units())]

    def _inertia(self) -> list[Row]:
        self.progress("run-down from 2°/s")
        fit = self.record.fits.get("low")
        if fit is None:
            raise ValueError("the friction characteristic of low preload (E7) is missing")
        sheet = data_sheet(self.plants["low"])
        downs = [fit_inertia(runs.run_down(self.bench("low"), way), fit, sheet) for way in (1, -1)]
        self.record.run_down = downs[0]
        return [judge_models.e8(downs)]

    def _table_units(self) -> dict[str, float]:
        """Return what turns N m at the axis into the unit in which each plant reads Table 2's torques."""
        return {name: plant.axes.ra.friction.coulomb.value / plant.axes.ra.friction.coulomb.si
                for name, plant in self.plants.items()}  # fmt: skip

    def _map(self, preload: str, sheet: DataSheet) -> None:
        """Torque-velocity map of one preload: steady states, and the break-away torque as its point at
        rest."""
        self.progress(f"break-away, {preload} preload")
        ways = [runs.break_away(self.bench(preload), way) for way in (1, -1)]
        points = [break_away_point(ways[0], ways[1], sheet)]
        left_out = []
        for speed, forward, backward in runs.velocity_map(self.bench(preload), self.progress):
            point = steady_point(forward, backward, sheet)
            if steady(speed, point, (forward, backward)):
                points.append(point)
            else:
                left_out.append(speed)
        self.record.points[preload] = points
        self.record.left_out[preload] = left_out
        # four parameters, as Table 2 has: the exponent is "the empirical parameter", chosen beforehand
        exponent = self.plants[preload].axes.ra.friction.stribeck_exponent.si
        self.record.fits[preload] = fit_friction(points, exponent)

    def _linear(self) -> list[Row]:
        self.progress("step to 600″/s")
        plant = self.plants["low"]
        self.record.step = log = runs.step(self.bench("low"), runs.STEP_TO)
        controller = plant.controller
        gains = (controller.kp.si, controller.ki.si)
        steps, seconds = round(controller.pwm_steps.si), float(log.t_s.size * LOG_PERIOD_S)
        to = runs.STEP_TO
        self.record.linear = simulate_loop(linear_axis(plant), gains, steps, to, seconds, RAMP_ARCSEC_S2)
        t, rate, _ = self.record.linear
        return [judge_models.e9(step_response(log.t_s, log.rate, to), step_response(t, rate, to), to)]

    def _tuning(self) -> list[Row]:
        self.progress("loop with the tuning rule's gains")
        plant = self.plants["low"]
        model = reduce_to_dead_time(linear_axis(plant), round(plant.controller.pwm_steps.si))
        rule = judge_models.tuned(model, plant)
        gains = (rule.gains.kp, rule.gains.ki)
        tracking = runs.tracking(self.bench("low", gains), 30.0)
        high = {
            speed: self.bench("low", gains).closed_loop(speed, 16.0).after(4.0) for speed in (600.0, 1000.0)
        }
        return [judge_models.e10(rule, tracking, high)]
