"""One held-out run driven again: the log's set point (or effort) into the compiled loop, columns out."""

from dataclasses import dataclass, replace

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.frame import Frame, fill
from calibration.names import NAMES
from calibration.replay.gains import Gains
from calibration.replay.thresholds import AT_REST, LEAD_ROWS, LEAST_RATE
from plant.effects.signals import ANGLE, CURRENT, MOTOR, RATE, TIME
from plant.evaluate import signals
from plant.model import PlantModel, with_effects, with_value
from plant.parts import EffectModel
from plant.rows import values
from plant.units import ARCSEC, factor


@dataclass(frozen=True, kw_only=True)
class Trace:
    """Motor torque N m (K N (i_a - i_b)), velocity arcsec/s (5 ms counts), position arcsec; one per row."""

    torque: Array
    velocity: Array
    position: Array
    ripple: Array | None = None  # N m that sampling at the PWM's edge adds to a replayed torque


@dataclass(frozen=True, kw_only=True)
class Loop:
    """A log's loop, to be run again along its runs: N m at the axis per ampere, gains as identified."""

    frame: Frame
    axis: str
    per_ampere: float
    gains: Gains | None

    def measured(self, rows: Mask) -> Trace:
        """What the log says on the rows of one run. NaN where it has no row or no such column, and of the
        torque where a converter is at its end."""
        torque = np.full(int(rows.sum()), np.nan)
        ia, ib, v = (self.frame.get(name) for name in ("current_a", "current_b", "velocity"))
        if ia is not None and ib is not None:
            ended = self.frame.saturated(ia) | self.frame.saturated(ib)
            torque = np.where(ended, np.nan, self.per_ampere * (ia - ib))[rows]
        return Trace(
            torque=torque,
            velocity=v[rows] / ARCSEC if v is not None else np.full(len(torque), np.nan),
            position=self.frame.columns["position"][rows] / ARCSEC,
        )

    def again(self, model: PlantModel, rows: Mask, nudge: Array) -> Trace:
        """Run `model` from the state of the first of `rows` (one run) under the run's own command. It is
        closed loop where the log has a set point, to which `nudge` (arcsec/s, one per row) is added.
        Elsewhere it is open loop on the logged effort. Raises ValueError where the plant cannot be run."""
        from plant.loop import Excitation, simulate

        frame, scale = self.frame, self.frame.scale
        start_s = float(frame.one_clock[rows][0])
        model = self._prepared(model, rows, start_s)
        position, _ = fill(frame.columns["position"][rows], frame.run[rows])
        effort, _ = fill(frame.columns["effort"][rows], frame.run[rows])
        wanted = ticks(_held(frame.columns["setpoint"][rows], frame.present[rows]) / ARCSEC)
        wanted += np.repeat(nudge, 2)
        closed = np.isfinite(wanted)
        if abs(effort[0]) > AT_REST:
            wanted[: 2 * LEAD_ROWS] = np.nan
        per_count = scale["position_arcsec_per_count"] * ARCSEC
        rate = float(position[min(LEAD_ROWS, len(position) - 1)] - position[0]) / LEAD_ROWS / frame.period_s
        command = Excitation(
            setpoint=wanted if closed.any() else None,
            effort=effort * 3000.0,
            start_steps=float(position[0]) / per_count + 0.5,
            start_rate=rate / ARCSEC if abs(rate) > LEAST_RATE else 0.0,
            start_s=start_s,
            history=before_start(frame, rows),
        )
        per_ampere = 1.0 / scale["adc_A_per_count"]
        duration_s = len(position) * frame.period_s
        log = simulate(model, self.axis, duration_s, command, adc_counts_per_A=per_ampere)
        inductance = getattr(model.axes, self.axis).motor.inductance.si
        # A that the PWM's ripple adds to a current at the sampling edge, per d (1 - d) of the duty
        ripple = model.supply.voltage.si / (2.0 * inductance * model.controller.pwm_frequency.si)
        adc = np.stack([log.adc_a, log.adc_b])
        duty = np.stack([log.truth["duty_a"], log.truth["duty_b"]])
        peaks = np.where(adc > 0, ripple * duty * (1.0 - duty), 0.0)
        ampere = np.where(adc > 0, (adc + 0.5) * scale["adc_A_per_count"] - peaks, 0.0)
        return Trace(
            torque=self.per_ampere * (ampere[0] - ampere[1]),
            velocity=log.velocity * scale["velocity_arcsec_per_count"] / scale["velocity_window_s"],
            position=np.unwrap(log.position, period=2.0**29) * scale["position_arcsec_per_count"],
            ripple=self.per_ampere * (peaks[0] - peaks[1]),
        )

    def _prepared(self, model: PlantModel, rows: Mask, start_s: float) -> PlantModel:
        """The model with this run's supply, counter torque, warmth and gains, and what of its effects
        repeats. Warmth gathered before the run is put into the depth of the warm-up."""
        scales = self.frame.runs[int(self.frame.run[rows][0])].scales
        temperature = self.frame.columns["temperature"][rows]
        numbers = {"supply.voltage": scales["supply_V"], "controller.counter_split": scales["counter_torque"]}
        if np.isfinite(temperature).sum() > 1:
            seen = np.flatnonzero(np.isfinite(temperature))
            warming, start = np.polyfit(seen * scales["sample_period_s"], temperature[seen], 1)
            numbers["environment.temperature"] = start - warming * start_s
            numbers["environment.warming"] = warming * factor("K/s", model.environment.warming.unit)
        if self.gains is not None:
            numbers |= {"controller.kp": self.gains.kp, "controller.ki": self.gains.ki}
        for path, value in numbers.items():
            model = with_value(model, path, value)
        kept = []
        for effect in filter(repeats, getattr(model.axes, self.axis).effects):
            if effect.name == "friction_warmup" and start_s > 0.0:
                given = values(effect)
                depth = given["depth"] * float(np.exp(-start_s / given["time_constant"]))
                number = replace(effect.parameters["depth"], value=depth)
                effect = replace(effect, parameters={**effect.parameters, "depth": number})
            kept.append(effect)
        return with_effects(model, self.axis, kept)


def repeats(effect: EffectModel) -> bool:
    """Whether an effect has a trace to repeat: noise has none, nor a line of a new phase in every run."""
    return not (effect.enabled and NAMES[effect.name].random)


def before_start(frame: Frame, rows: Mask) -> Array | None:
    """Signal vectors (2 motors, n, VECTOR) of the session's rows before `rows`; None without any."""
    first = int(np.flatnonzero(rows)[0])
    clock = frame.one_clock
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
    """A set point through rows that are missing: the last row's stays in force. One without any is open loop,
    and so is what follows it."""
    at = np.where(present, np.arange(len(x)), -1)
    np.maximum.accumulate(at, out=at)
    return np.where(at >= 0, x[at], np.nan)


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
