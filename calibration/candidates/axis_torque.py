"""Torque effects of the telescope drive that are no lines: friction, slow changes, imbalance, sensors of
current."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate, ramp
from calibration.candidates.context import Context
from calibration.candidates.friction import stop_operator
from calibration.channels.level import Level
from calibration.readers.run import Array

# of a current's gain error: one motor's torque is most of the torque, and would explain itself
LARGEST_GAIN = 0.5
PASSIVE = 1.0  # of the friction itself: a larger asymmetry would drive the axis in one direction


@dataclass
class Friction:
    """Declared friction along the log: `level` at full rate, `viscous` N m signed; currents as N m; session
    time s."""

    level: Level
    viscous: Array
    lagging: Array  # torque of the motor that holds the counter torque, N m signed
    torque_a: Array
    torque_b: Array
    load: Array  # declared model's torque, N m: the measured one would explain itself
    clock: Array

    @property
    def transmitted(self) -> Array:
        """Torque through both trains at full rate, N m: they pull against each other."""
        both = np.abs(self.load) + 2 * np.abs(self.lagging)
        pick = self.level.motion.pick
        return np.asarray(np.interp(np.arange(len(self.level.clock)), pick, both))


def direction_effects(c: Context, f: Friction) -> list[Candidate]:
    """Asymmetry, load friction, offset and gain of the current reading."""
    sided = f.level.answer(f.level.side * f.level.steady)
    return [
        Candidate(
            "friction_asymmetry",
            "velocity",
            np.column_stack([sided, np.abs(f.viscous)]),
            (("coulomb_asymmetry", "1"), ("viscous_asymmetry", "1")),
            most=PASSIVE,
        ),
        Candidate(
            "friction_asymmetry", "velocity", sided[:, None], (("coulomb_asymmetry", "1"),), most=PASSIVE
        ),
        Candidate("load_friction", "current", f.level.answer(f.transmitted)[:, None], (("mu", "1"),), sign=1),
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
    level = f.level
    since, full = _since_start(f.clock, c.session), _since_start(level.clock, level.session)
    out = []
    for tau in (15.0, 30.0, 60.0, 100.0, 150.0, 220.0, 320.0):
        if tau > 3 * span:
            continue
        for viscous in (True, False):
            shape = warmup(f, since, full, viscous)
            out.append(
                Candidate(
                    "friction_warmup",
                    "time",
                    shape(np.array([tau])),
                    (("amplitude", "1"),),
                    fixed={"tau": (tau, "s")},
                    shape=shape,
                    steps=(0.2 * tau,),
                )
            )
    for at in np.linspace(0.03, 0.97, 26) * span + low:
        if not 0.02 < np.mean(f.clock > at) < 0.98:
            continue
        shape = _onset(f)
        out.append(
            Candidate(
                "brake_drag",
                "time",
                shape(np.array([at])),
                (("torque", "N m"),),
                fixed={"onset": (float(at), "s")},
                shape=shape,
                steps=(0.02 * span,),
            )
        )
    for at in np.linspace(-0.4, 0.95, 19) * span + low:
        for part in (0.02, 0.2, 0.5, 1.0):
            shape = _ramp(f)
            columns = shape(np.array([at, part * span]))
            if np.ptp(columns) > 0 and np.mean(np.abs(columns) > 0) > 0.02:
                out.append(
                    Candidate(
                        "preload_change",
                        "time",
                        columns,
                        (("fraction", "1"),),
                        most=1.0,
                        shape=shape,
                        steps=(0.02 * span, 0.08 * max(part, 0.1) * span),
                        fixed={"onset": (float(at), "s"), "ramp": (part * span, "s")},
                    )
                )
                shape = _weaker(f)
                out.append(
                    Candidate(
                        "magnet_weakening",
                        "time",
                        shape(np.array([at, part * span])),
                        (("fraction", "1"),),
                        shape=shape,
                        steps=(0.02 * span, 0.08 * max(part, 0.1) * span),
                        fixed={"onset": (float(at), "s"), "ramp": (part * span, "s")},
                        sign=1,
                    )
                )
    return out


def warmup(f: Friction, since: Array, full: Array, viscous: bool) -> Callable[[Array], Array]:
    """Torque of a relative rise that decays with the time since the start, s: `since` (n_analysis,), `full`
    (n,); with the viscous friction, or the bristles' alone."""

    def shape(p: Array) -> Array:
        tau = max(float(p[0]), 1.0)
        out = f.level.answer(f.level.steady * np.exp(-full / tau))
        return (out + f.viscous * np.exp(-since / tau) if viscous else out)[:, None]

    return shape


def _onset(f: Friction) -> Callable[[Array], Array]:
    return lambda p: f.level.answer((f.level.clock > p[0]).astype(float))[:, None]


def _weaker(f: Friction) -> Callable[[Array], Array]:
    """Torque that the currents promise and the magnets do not give: a share of the whole torque."""
    return lambda p: (f.load * ramp(f.clock, float(p[0]), float(p[1])))[:, None]


def _ramp(f: Friction) -> Callable[[Array], Array]:
    def shape(p: Array) -> Array:
        full, here = (ramp(clock, float(p[0]), float(p[1])) for clock in (f.level.clock, f.clock))
        return (f.level.answer(f.level.stiction * full) + f.viscous * here)[:, None]

    return shape


def _since_start(clock: Array, session: NDArray[np.int64]) -> Array:
    out = clock.copy()
    for k in np.unique(session):
        m = session == k
        out[m] -= clock[m].min()
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
