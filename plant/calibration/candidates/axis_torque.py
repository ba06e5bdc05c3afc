"""Torque effects of the telescope drive that are no lines: friction, slow changes, imbalance, sensors of current."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.candidates.context import Context
from plant.calibration.candidates.friction import stop_operator
from plant.calibration.readers.run import Array


@dataclass
class Friction:
    """Declared friction along the log: `bristle` N m signed, `viscous` N m signed; currents as N m; session time s."""

    bristle: Array
    viscous: Array
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
    out = [
        Candidate("friction_asymmetry", "velocity", np.column_stack([np.abs(f.bristle), np.abs(f.viscous)]),
                  (("coulomb_asymmetry", "1"), ("viscous_asymmetry", "1"))),
        Candidate("friction_asymmetry", "velocity", np.abs(f.bristle)[:, None], (("coulomb_asymmetry", "1"),)),
        Candidate("load_friction", "current", (f.sliding * np.abs(f.load))[:, None], (("mu", "1"),), sign=1),
        Candidate("adc_offset", "current", np.ones((len(c.t), 1)), (("offset_torque", "N m"),)),
        Candidate("adc_gain", "current", f.torque_a[:, None], (("gain_a", "1"),)),
        Candidate("adc_gain", "current", f.torque_b[:, None], (("gain_b", "1"),)),
    ]
    return out


def angle_effects(c: Context) -> list[Candidate]:
    """Imbalance at the absolute angle; cable wrap as a spring with a loop."""
    x = c.angle
    out = [Candidate("gravity_imbalance", "axis_angle", np.column_stack([np.cos(x), np.sin(x)]),
                     (("amplitude", "N m"),), kind="line", stage="axis", harmonic=1, order=1.0)]
    span = float(np.ptp(x)) or 1.0
    spring = x - x.mean()
    for part in (0.02, 0.06, 0.15, 0.3):
        loop = stop_operator(x, c.session, part * span) / (part * span)
        out.append(Candidate("cable_wrap", "axis_angle", np.column_stack([spring, np.ones(len(x)), loop]),
                             (("spring", "N m/rad"), ("neutral_torque", "N m"), ("loop_torque", "N m")),
                             fixed={"loop_travel": (part * span, "rad")}))
    return out


def slow_effects(c: Context, f: Friction) -> list[Candidate]:
    """Warm-up, preload that changes, brake that drags: friction that knows the time."""
    span = float(np.ptp(f.clock)) or 1.0
    out = []
    for tau in (15.0, 30.0, 60.0, 100.0, 150.0, 220.0, 320.0):
        if tau > 3 * span:
            continue
        out.append(Candidate("friction_warmup", "time", (f.total * np.exp(-_since_start(c, f) / tau))[:, None],
                             (("amplitude", "1"),), fixed={"tau": (tau, "s")}))
    low, high = float(f.clock.min()), float(f.clock.max())
    for at in np.linspace(0.04, 0.96, 24) * (high - low) + low:
        on = (f.clock > at).astype(float)
        fixed = {"onset": (float(at), "s")}
        out.append(Candidate("preload_change", "time", (f.total * on)[:, None], (("fraction", "1"),), fixed=fixed))
        out.append(Candidate("brake_drag", "time", (f.sliding * on)[:, None], (("torque", "N m"),), fixed=fixed))
    for at in np.linspace(-0.5, 0.9, 15) * (high - low) + low:
        for ramp in (0.2, 0.5, 1.0):
            shape = np.clip((f.clock - at) / (ramp * (high - low)), 0, 1)
            if np.ptp(shape) < 0.1:
                continue
            out.append(Candidate("preload_change", "time", (f.total * shape)[:, None], (("fraction", "1"),),
                                 fixed={"onset": (float(at), "s"), "ramp": (ramp * (high - low), "s")}))
    return out


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
