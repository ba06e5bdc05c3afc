"""Torque effects of the telescope drive that are no lines: friction, slow changes, imbalance, sensors of
current."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.candidates.context import Context
from plant.calibration.candidates.friction import stop_operator
from plant.calibration.readers.run import Array

# of a current's gain error: one motor's torque is most of the torque, and would explain itself
LARGEST_GAIN = 0.5


@dataclass
class Friction:
    """Declared friction along the log: `bristle` N m signed, `viscous` N m signed; currents as N m; session
    time s."""

    bristle: Array
    uneven: Array  # N m per unit of asymmetry
    stiction: Array  # what the bristle changes per relative change of Ts
    viscous: Array
    lagging: Array  # torque of the motor that holds the counter torque, N m signed
    torque_a: Array
    torque_b: Array
    load: Array  # declared model's torque, N m: the measured one would explain itself
    clock: Array

    @property
    def sliding(self) -> Array:
        """-1..1: the direction of sliding friction, soft while the bristles turn over."""
        return np.clip(self.bristle / (0.5 * float(np.quantile(np.abs(self.bristle), 0.6)) + 1e-9), -1, 1)

    @property
    def total(self) -> Array:
        """Friction torque, signed."""
        return self.bristle + self.viscous


def direction_effects(c: Context, f: Friction) -> list[Candidate]:
    """Asymmetry, load friction, offset and gain of the current reading."""
    return [
        Candidate(
            "friction_asymmetry",
            "velocity",
            np.column_stack([f.uneven, np.abs(f.viscous)]),
            (("coulomb_asymmetry", "1"), ("viscous_asymmetry", "1")),
        ),
        Candidate("friction_asymmetry", "velocity", f.uneven[:, None], (("coulomb_asymmetry", "1"),)),
        Candidate("load_friction", "current", (f.sliding * np.abs(f.load))[:, None], (("mu", "1"),), sign=1),
        Candidate(
            "load_friction",
            "current",
            (f.bristle / (float(np.median(np.abs(f.bristle))) + 1e-9) * np.abs(f.load))[:, None],
            (("mu", "1"),),
            sign=1,
        ),
        Candidate("adc_offset", "current", np.ones((len(c.t), 1)), (("offset_torque", "N m"),)),
        Candidate("adc_gain", "current", f.torque_a[:, None], (("gain_a", "1"),), most=LARGEST_GAIN),
        Candidate("adc_gain", "current", f.torque_b[:, None], (("gain_b", "1"),), most=LARGEST_GAIN),
    ]


def angle_effects(c: Context) -> list[Candidate]:
    """Imbalance at the absolute angle; cable wrap as a spring with a loop."""
    x = c.angle
    out = [
        Candidate(
            "gravity_imbalance",
            "axis_angle",
            np.column_stack([np.cos(x), np.sin(x)]),
            (("amplitude", "N m"),),
            kind="line",
            stage="axis",
            harmonic=1,
            order=1.0,
        )
    ]
    span = float(np.ptp(x)) or 1.0
    spring = x - x.mean()
    for travel in (0.01, 0.02, 0.04, 0.07, 0.1, 0.15, 0.25):
        if travel > span:
            continue
        shape = _cable(x, spring, c.session)
        out.append(
            Candidate(
                "cable_wrap",
                "axis_angle",
                shape(np.array([travel])),
                (("stiffness", "N m/rad"), ("neutral_torque", "N m"), ("loop", "N m")),
                fixed={"loop_travel": (travel, "rad")},
                shape=shape,
                steps=(0.1 * travel,),
                positive=(0, 2),
            )
        )
    return out


def _cable(x: Array, spring: Array, session: NDArray[np.int64]) -> Callable[[Array], Array]:
    def shape(p: Array) -> Array:
        travel = max(float(p[0]), 1e-4)
        loop = stop_operator(x, session, travel) / travel
        return np.column_stack([spring, np.ones(len(x)), loop])

    return shape


def slow_effects(c: Context, f: Friction) -> list[Candidate]:
    """Warm-up, preload that changes, brake that drags: torque that knows the time."""
    low, high = float(f.clock.min()), float(f.clock.max())
    span = (high - low) or 1.0
    since = _since_start(c, f)
    out = []
    for tau in (15.0, 30.0, 60.0, 100.0, 150.0, 220.0, 320.0):
        if tau > 3 * span:
            continue
        for weight, labels in (
            (f.total[:, None], (("amplitude", "1"),)),
            (
                np.column_stack([f.bristle, f.stiction, f.viscous]),
                (("amplitude", "1"), ("stiction_rise", "1"), ("viscous_rise", "1")),
            ),
        ):
            shape = _warmup(weight, since)
            out.append(
                Candidate(
                    "friction_warmup",
                    "time",
                    shape(np.array([tau])),
                    labels,
                    fixed={"tau": (tau, "s")},
                    shape=shape,
                    steps=(0.05 * tau,),
                    least=60.0 if weight.shape[1] > 1 else 0.0,
                )
            )
    preload = f.stiction + f.viscous
    kinds = (("preload_change", preload, "fraction", "1"), ("brake_drag", f.sliding, "torque", "N m"))
    for at in np.linspace(0.03, 0.97, 26) * span + low:
        for name, weight, label, unit in kinds:
            if not 0.02 < np.mean(f.clock > at) < 0.98:
                continue
            shape = _onset(weight, f.clock)
            out.append(
                Candidate(
                    name,
                    "time",
                    shape(np.array([at])),
                    ((label, unit),),
                    fixed={"onset": (float(at), "s")},
                    shape=shape,
                    steps=(0.02 * span,),
                )
            )
    for at in np.linspace(-0.4, 0.9, 14) * span + low:
        for ramp in (0.2, 0.5, 1.0):
            for name, weight, label, unit in kinds[:1]:
                shape = _ramp(weight, f.clock)
                columns = shape(np.array([at, ramp * span]))
                if np.ptp(columns) > 0 and np.mean(np.abs(columns) > 0) > 0.02:
                    out.append(
                        Candidate(
                            name,
                            "time",
                            columns,
                            ((label, unit),),
                            shape=shape,
                            steps=(0.02 * span, 0.02 * span),
                            fixed={"onset": (float(at), "s"), "ramp": (ramp * span, "s")},
                        )
                    )
    return out


def _warmup(weight: Array, since: Array) -> Callable[[Array], Array]:
    return lambda p: weight * np.exp(-since / max(float(p[0]), 1.0))[:, None]


def _onset(weight: Array, clock: Array) -> Callable[[Array], Array]:
    return lambda p: (weight * (clock > p[0]))[:, None]


def _ramp(weight: Array, clock: Array) -> Callable[[Array], Array]:
    return lambda p: (weight * np.clip((clock - p[0]) / max(float(p[1]), 1.0), 0, 1))[:, None]


def _since_start(c: Context, f: Friction) -> Array:
    out = f.clock.copy()
    for k in np.unique(c.session):
        m = c.session == k
        out[m] -= f.clock[m].min()
    return out


def start_clock(starts: list[str], t: Array, run: NDArray[np.int64]) -> Array:
    """Time of every row on one clock, from the runs' `start_utc`; falls back to the order of the files."""
    from datetime import datetime

    try:
        begin = [datetime.fromisoformat(s.replace("Z", "+00:00")).timestamp() for s in starts]
    except ValueError:
        return t
    out = t.copy()
    zero = min(begin)
    for k in range(len(starts)):
        m = run == k
        if m.any():
            out[m] += begin[k] - zero - t[m].min()
    return out if np.ptp(out) < 50 * np.ptp(t) + 1 else t
