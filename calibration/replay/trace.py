"""One held-out run driven again: the log's set point (or effort) into the compiled loop, columns out."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from calibration.candidates.axis_torque import start_clock
from calibration.channels.frame import Frame, fill
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.replay.gains import Gains
from calibration.statistics.whitening import Mask
from plant.effects.evaluate import signals
from plant.effects.rows import values
from plant.effects.signals import ANGLE, CURRENT, MOTOR, RATE, TIME
from plant.model import PlantModel, with_effects, with_value

SECONDS_PER = {"K/s": 1.0, "K/h": 3600.0}
LEAD_ROWS = 5  # rows driven by the logged effort before the loop closes: its integrator then starts as logged
AT_REST = 3e-3  # of full effort: a log that starts with less starts with an empty integrator
LEAST_RATE = 3.0 * ARCSEC  # rad/s; slower, the axis is taken to start at rest


@dataclass(frozen=True)
class Trace:
    """Motor torque N m (K N (i_a - i_b)), velocity arcsec/s (5 ms counts), position arcsec; one per row."""

    torque: Array
    velocity: Array
    position: Array
    ripple: Array | None = None  # N m that sampling at the PWM's edge adds to a replayed torque


def measured(frame: Frame, rows: Mask, per_ampere: float) -> Trace:
    """What the log says on the rows of one run; NaN where it has no row or no such column."""
    nothing = np.full(int(rows.sum()), np.nan)
    ia, ib, v = (frame.get(name) for name in ("current_a", "current_b", "velocity"))
    return Trace(
        per_ampere * (ia[rows] - ib[rows]) if ia is not None and ib is not None else nothing,
        v[rows] / ARCSEC if v is not None else nothing,
        frame.columns["position"][rows] / ARCSEC,
    )


def drive_again(
    model: PlantModel, axis: str, frame: Frame, rows: Mask, per_ampere: float, start_s: float = 0.0
) -> Trace:
    """Run `model` from the state of the first of `rows` (one run, all of it) under the run's own command.

    Closed loop where the log has a set point, open loop on the logged effort elsewhere. `start_s` is the
    first row's time on the clock that effects in time were fitted on.
    """
    from plant.loop import simulate

    scale = frame.scale
    position, _ = fill(frame.columns["position"][rows], frame.run[rows])
    effort, _ = fill(frame.columns["effort"][rows], frame.run[rows])
    wanted = ticks(_held(frame.columns["setpoint"][rows], frame.present[rows]) / ARCSEC)
    closed = np.isfinite(wanted)
    if abs(effort[0]) > AT_REST:
        wanted[: 2 * LEAD_ROWS] = np.nan
    per_count = scale["position_arcsec_per_count"] * ARCSEC
    rate = float(position[min(LEAD_ROWS, len(position) - 1)] - position[0]) / LEAD_ROWS / frame.period_s
    log = simulate(
        model,
        axis,
        len(position) * frame.period_s,
        setpoint=wanted if closed.any() else None,
        effort=effort * 3000.0,
        start_steps=float(position[0]) / per_count + 0.5,
        start_rate=rate / ARCSEC if abs(rate) > LEAST_RATE else 0.0,
        start_s=start_s,
        history=before_start(frame, rows),
        adc_counts_per_A=1.0 / scale["adc_A_per_count"],
    )
    count = scale["velocity_arcsec_per_count"] / scale["velocity_window_s"]
    per = scale["adc_A_per_count"]
    peaks = [
        _ripple(model, axis, adc, log.truth[d]) for adc, d in ((log.adc_a, "duty_a"), (log.adc_b, "duty_b"))
    ]
    ampere = [
        np.where(adc > 0, (adc + 0.5) * per - peak, 0.0)
        for adc, peak in zip((log.adc_a, log.adc_b), peaks, strict=True)
    ]
    turned = np.unwrap(log.position, period=2.0**29)
    return Trace(
        per_ampere * (ampere[0] - ampere[1]),
        log.velocity * count,
        turned * scale["position_arcsec_per_count"],
        per_ampere * (peaks[0] - peaks[1]),
    )


def before_start(frame: Frame, rows: Mask) -> Array | None:
    """Signal vectors (2 motors, n, VECTOR) of the session's rows before `rows`; None without any."""
    first = int(np.flatnonzero(rows)[0])
    clock = start_clock([r.header.get("start_utc", "") for r in frame.runs], frame.t, frame.run)
    earlier = np.flatnonzero((frame.session == frame.session[first]) & (clock < clock[first]) & ~rows)
    if len(earlier) < 2:
        return None
    earlier = earlier[np.argsort(clock[earlier], kind="stable")]
    angle = fill(frame.columns["position"], frame.run)[0][earlier]
    time = clock[earlier]
    rate = np.gradient(angle) / np.maximum(np.gradient(time), frame.period_s)
    parts = []
    for motor, key in enumerate("ab"):
        current = fill(frame.columns[f"current_{key}"], frame.run)[0][earlier]
        columns = {TIME: time, ANGLE: angle, RATE: rate, CURRENT: current}
        parts.append(signals(len(earlier), {**columns, MOTOR: np.full(len(earlier), float(motor))}))
    return np.stack(parts)


def _held(x: Array, present: Mask) -> Array:
    """A set point through rows that are missing: the last row's stays in force; one without any is open loop,
    and so is what follows it."""
    at = np.where(present, np.arange(len(x)), -1)
    np.maximum.accumulate(at, out=at)
    return np.where(at >= 0, x[np.maximum(at, 0)], np.nan)


def ticks(wanted: Array) -> Array:
    """Set points of both control ticks of every row: between the rows of a ramp the mean, else the last one.

    The boards change a set point by the same step in every tick of 5 ms, of which the log shows every second.
    """
    out = np.repeat(wanted, 2)
    step = np.diff(wanted)
    ramp = np.zeros(len(step), dtype=bool)
    same = (np.abs(step[1:] - step[:-1]) < 0.5 * np.abs(step[1:])) & (step[1:] != 0.0)
    ramp[1:] |= same
    ramp[:-1] |= same
    out[1:-1:2] = np.where(ramp, 0.5 * (wanted[1:] + wanted[:-1]), wanted[:-1])
    return out


def _ripple(model: PlantModel, axis: str, adc: Array, duty: Array) -> Array:
    """What the PWM's ripple adds to a current at the sampling edge, A, where the reading is not zero."""
    inductance = getattr(model.axes, axis).motor.inductance.si
    size = model.supply.voltage.si / (2.0 * inductance * model.controller.pwm_frequency.si)
    return np.where(adc > 0, size * duty * (1.0 - duty), 0.0)


def model_for_run(
    model: PlantModel,
    axis: str,
    scales: dict[str, float],
    gains: Gains | None,
    start_s: float,
    temperature: Array | None = None,
) -> tuple[PlantModel, list[str]]:
    """The model with this run's supply, counter torque and gains, without what has no trace to repeat.

    Returns it with the names of the effects that were left out: noise and lines whose phase is a new one in
    every run. Warmth gathered before the run is put into the depth of the warm-up.
    """
    model = with_value(model, "supply.voltage", scales["supply_V"])
    model = with_value(model, "controller.counter_split", scales["counter_torque"])
    if temperature is not None and np.isfinite(temperature).sum() > 1:
        seen = np.flatnonzero(np.isfinite(temperature))
        warming, start = np.polyfit(seen * scales["sample_period_s"], temperature[seen], 1)
        model = with_value(model, "environment.temperature", start - warming * start_s)
        model = with_value(
            model, "environment.warming", warming * SECONDS_PER[model.environment.warming.unit]
        )
    if gains is not None:
        model = with_value(model, "controller.kp", gains.kp)
        model = with_value(model, "controller.ki", gains.ki)
    kept, left = [], []
    for effect in getattr(model.axes, axis).effects:
        given = values(effect) if effect.function is None else {}
        if effect.enabled and effect.name in ("wind_torque", "command_disturbance"):
            left.append(effect.name)
            continue
        if effect.name == "friction_warmup" and start_s > 0.0:
            depth = given["depth"] * float(np.exp(-start_s / given["time_constant"]))
            number = replace(effect.parameters["depth"], value=depth)
            effect = replace(effect, parameters={**effect.parameters, "depth": number})
        kept.append(effect)
    return with_effects(model, axis, kept), left
