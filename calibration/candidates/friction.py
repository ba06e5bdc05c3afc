"""Friction families: asymmetry, Stribeck, pre-sliding, position, load, warm-up, preload (effects.md,
channel T)."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate, sine_columns
from calibration.candidates.context import Context
from calibration.channels.recursions import stop_element
from calibration.readers.run import Array


def both_directions(c: Context) -> bool:
    """True when each direction holds at least a twentieth of the rows."""
    return bool(min(np.mean(c.direction > 0), np.mean(c.direction < 0)) > 0.05)


def asymmetry(c: Context) -> list[Candidate]:
    """Tc+ != Tc- (a constant), and with it sigma2+ != sigma2- (|speed|)."""
    if not both_directions(c):
        return []
    one = np.abs(c.direction)
    speed = np.abs(c.speed)
    per = f"{c.unit} s/{c.angle_unit}"
    out = [Candidate("friction_asymmetry", "velocity", one[:, None], (("coulomb_asymmetry", c.unit),))]
    if np.std(speed) > 0.1 * np.mean(speed):
        out.append(
            Candidate(
                "friction_asymmetry",
                "velocity",
                np.column_stack([one, speed]),
                (("coulomb_asymmetry", c.unit), ("viscous_asymmetry", per)),
            )
        )
    return out


def stribeck(c: Context) -> list[Candidate]:
    """sign(speed) exp(-(|speed|/vs)^2) over a grid of vs; only with speeds on both sides of vs."""
    speed = np.abs(c.speed)
    top = float(np.quantile(speed, 0.98))
    out = []
    for part in (0.01, 0.02, 0.05, 0.1, 0.2, 0.4):
        vs = part * top
        low = np.mean((speed < vs) & (speed > 0.1 * vs))
        if low < 0.005 or top < 2.5 * vs:
            continue
        shape = c.direction * np.exp(-((speed / vs) ** 2))
        out.append(
            Candidate(
                "stribeck_change",
                "velocity",
                shape[:, None],
                (("stribeck_torque", c.unit),),
                fixed={"stribeck_speed": (vs, f"{c.angle_unit}/s")},
            )
        )
    return out


def stop_operator(angle: Array, run: NDArray[np.int64], radius: float) -> Array:
    """The elastoplastic loop: follows the travel with slope 1 and saturates at +-radius; shape like `angle`.

    Zero at the start of a run. The parallel sum of such elements is the Prandtl model of pre-sliding
    friction.
    """
    fresh = np.concatenate([[True], np.diff(run) != 0])
    return np.asarray(stop_element(np.ascontiguousarray(angle), fresh, float(radius)))


def presliding(c: Context) -> list[Candidate]:
    """Hysteresis over the travel since reversal, one or two elastoplastic elements, over a grid of radii.

    A column is the element less the sign of motion: it adds the loop and leaves the sliding friction alone.
    """
    if not both_directions(c):
        return []
    stroke = float(np.quantile(np.abs(c.since), 0.95)) or 1.0
    label = (("loop_torque", c.unit), ("second_loop_torque", c.unit))
    out = []
    for part in (0.005, 0.01, 0.02, 0.04, 0.08, 0.14, 0.2, 0.28, 0.36):
        radius = part * stroke
        if np.mean(np.abs(c.since) < 2 * radius) < 0.005:
            continue
        one = stop_operator(c.angle, c.run, radius) / radius - c.direction
        two = stop_operator(c.angle, c.run, radius / 2) / (radius / 2) - c.direction
        fixed = {"breakaway_travel": (radius, c.angle_unit)}
        out.append(Candidate("presliding", "reversal", one[:, None], label[:1], fixed=fixed))
        out.append(Candidate("presliding", "reversal", np.column_stack([one, two]), label, fixed=fixed))
    return out


def position_friction(c: Context, harmonics: int = 3) -> list[Candidate]:
    """sign(speed) c(angle): odd in direction; sines over the travelled range and over every slow stage."""
    if not both_directions(c):
        return []
    out = []
    span = float(np.ptp(c.angle)) or 1.0
    period = min(span, c.turn)
    for h in range(1, harmonics + 1):
        x = c.angle * h / period
        out.append(
            Candidate(
                "position_friction",
                "axis_angle",
                sine_columns(x, np.zeros_like(c.session), c.direction),
                (("amplitude", c.unit),),
                kind="line",
                order=c.turn * h / period,
                stage="axis",
                harmonic=h,
            )
        )
    for stage, per_unit in c.stages.items():
        if stage == "axis":
            continue
        for h in (1, 2):
            if span * per_unit * h < 1.5:
                continue
            out.append(
                Candidate(
                    "position_friction",
                    "axis_angle",
                    sine_columns(c.angle * per_unit * h, c.session, c.direction),
                    (("amplitude", c.unit),),
                    kind="line",
                    stage=stage,
                    harmonic=h,
                    order=per_unit * h * c.turn,
                )
            )
    return out


def load_friction(c: Context) -> list[Candidate]:
    """mu |transmitted torque| against the motion."""
    if c.load is None:
        return []
    return [
        Candidate(
            "load_friction",
            "current",
            (c.direction * np.abs(c.load))[:, None],
            (("coefficient", "1"),),
            sign=1,
        )
    ]


def slow_changes(c: Context) -> list[Candidate]:
    """Friction that decays after the start or follows the temperature, and friction that steps or drifts."""
    weight = c.direction * c.friction
    span = float(np.ptp(c.t)) or 1.0
    out = []
    start = _time_in_session(c)
    for part in (0.05, 0.1, 0.2, 0.4, 0.8):
        tau = part * span
        out.append(
            Candidate(
                "friction_warmup",
                "time",
                (weight * np.exp(-start / tau))[:, None],
                (("relative_rise", "1"),),
                fixed={"tau": (tau, "s")},
                sign=0,
            )
        )
    if c.temperature is not None and np.ptp(c.temperature) > 0.5:
        out.append(
            Candidate(
                "friction_warmup",
                "temperature",
                (weight * (c.temperature - c.temperature.mean()))[:, None],
                (("relative_per_degree", "1/K"),),
            )
        )
    for at in np.linspace(0.08, 0.92, 22) * span + c.t[0]:
        out.append(
            Candidate(
                "preload_change",
                "time",
                (weight * (c.t > at))[:, None],
                (("relative_change", "1"),),
                fixed={"time": (float(at), "s")},
            )
        )
    out.append(
        Candidate(
            "preload_change",
            "time",
            (weight * (c.t - c.t.mean()) / span)[:, None],
            (("relative_trend", "1"),),
        )
    )
    return out


def _time_in_session(c: Context) -> Array:
    out = c.t.copy()
    for k in np.unique(c.session):
        m = c.session == k
        out[m] -= c.t[m].min()
    return out
