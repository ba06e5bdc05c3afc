"""Moment of inertia from run-downs of several speeds, by least squares on the logged counts.

Unknown are the inertia, what the trains damp, and when within a period of the log the command took effect.
Friction is the map's, the rest the drive's data sheets. The paper computes what the motors still do from "the
applied voltage and electrical model of the motor". A bridge with freewheel diodes stops the axis within some
samples of the log, and its trains swing meanwhile. So a rigid mass will not do. The load turns against
friction, and each rotor pushes its own flank through its train (Table 1). The motor that is turned against
its pull brakes through its diode.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from scenarios.studies.paper import scales
from scenarios.studies.paper.friction_map import FrictionFit
from scenarios.studies.paper.measures import Array, Log

STEP_S = 0.25e-3
"""s: a tenth of what the fastest swing (rotor on its train, about 25 Hz) takes for one radian."""


@dataclass(frozen=True, kw_only=True)
class Coasting:
    """inertia: of the whole axis with rotors, kg m2. damping: of one train, N m s/rad. late_s: from the
    command to the moment at which the duties fall, s."""

    inertia: float
    damping: float
    late_s: float


def settled(sheet: scales.Drive, current: Array, duty: Array, emf: Array) -> Array:
    """Return a motor's current a step later, A."""
    goal, resistance = sheet.tends(duty, emf)
    return np.maximum(0.0, goal + (current - goal) * np.exp(-resistance * STEP_S / sheet.inductance))


def coast(sheet: scales.Drive, friction: FrictionFit, axis: Coasting, speeds: Array, samples: int) -> Array:
    """Return the counts of 5 ms, shape (runs, samples), that the log has every 10 ms after "effort 0".

    speeds: rad/s > 0, one steady state for each run.
    """
    damping, late_s = axis.damping, axis.late_s
    k, n, load = sheet.torque_constant, scales.GEAR_RATIO, axis.inertia - 2.0 * sheet.rotor
    emf = k * n
    w = np.array(speeds, dtype=np.float64)
    lead_w, lag_w = w.copy(), w.copy()
    # before: both duties in the ratio of the split, together what friction takes
    duty = sheet.steady(friction.torque(w) / n, emf * w)
    lead_i = np.maximum(0.0, sheet.tends(duty, emf * w)[0])
    lag_i = np.maximum(0.0, sheet.tends(sheet.split * duty, -emf * w)[0])
    lead_x, lag_x = emf * lead_i / sheet.stiffness, -emf * lag_i / sheet.stiffness
    per_log, per_tick = round(scales.LOG_PERIOD_S / STEP_S), round(scales.CONTROL_PERIOD_S / STEP_S)
    travelled = np.zeros((samples * per_log, w.size))
    for step in range(samples * per_log):
        on = min(1.0, max(0.0, late_s / STEP_S - step))
        lead_i = settled(sheet, lead_i, on * duty, emf * lead_w)
        lag_i = settled(sheet, lag_i, on * sheet.split * duty, -emf * lag_w)
        push = np.maximum(0.0, sheet.stiffness * lead_x + damping * (lead_w - w))
        pull = np.maximum(0.0, -sheet.stiffness * lag_x - damping * (lag_w - w))
        before = w
        w = w + STEP_S * (push - pull - friction.torque(np.maximum(w, 1e-9))) / load
        w = np.where((w < 0.0) & (before >= 0.0), 0.0, w)
        lead_w = lead_w + STEP_S * (emf * lead_i - push) / sheet.rotor
        lag_w = lag_w + STEP_S * (pull - emf * lag_i) / sheet.rotor
        lead_x = lead_x + STEP_S * (lead_w - w)
        lag_x = lag_x + STEP_S * (lag_w - w)
        travelled[step] = w * STEP_S
    ticks = travelled.reshape(samples, per_log, w.size)[:, -per_tick:].sum(axis=1)
    return np.asarray(ticks.T / scales.CONTROL_PERIOD_S / scales.ARCSEC / scales.COUNT_RATE, dtype=np.float64)


INERTIA = (300.0, 10_000.0)
DAMPING = (300.0, 60_000.0)
LATE_S = (0.0, 0.025)
"""Bounds of the three: kg m2; N m s/rad of one train; s."""
SLOWEST = 60.0  # arcsec/s: below, bristles move more than they slide, which the map's curve does not know.
SPAN_S = 0.1  # s: the axis is slower than that within 0.08 s.


def fit_run_downs(
    logs: Sequence[Log], setpoints: Sequence[float], friction: FrictionFit, sheet: scales.Drive
) -> Coasting:
    """Return the inertia that explains all run-downs together.

    logs: each begins with the command "effort 0". setpoints: steady speeds before, arcsec/s, with sign. Both
    directions should be there: their mean is free of the axis' balance. Raises ValueError when no sample is
    fast enough to be used.
    """
    samples = min(round(SPAN_S / scales.LOG_PERIOD_S), *(log.t_s.size for log in logs))
    signs = np.sign(np.asarray(setpoints, dtype=np.float64))
    read = np.array([sign * log.rate[:samples] for sign, log in zip(signs, logs, strict=True)])
    counts = np.array([sign * log.counts[:samples] for sign, log in zip(signs, logs, strict=True)])
    speeds = np.abs(np.asarray(setpoints, dtype=np.float64)) * scales.ARCSEC
    used = np.minimum.accumulate(read, axis=1) > SLOWEST
    if used.sum() < 6:
        raise ValueError(f"only {used.sum()} samples of the run-downs are usable; at least 6 are needed")

    def model(x: Array) -> Array:
        return coast(sheet, friction, _coasting(x), speeds, samples)

    # a run of 2 deg/s has larger errors than one of 600 arcsec/s: shares of the set point, and the quantum
    scale = (1.0 + 0.01 * np.abs(counts[:, :1])) * np.ones_like(counts)

    def misfit(x: Array) -> Array:
        return np.asarray(((model(x) - counts) / scale)[used], dtype=np.float64)

    low = [np.log(INERTIA[0]), np.log(DAMPING[0]), LATE_S[0]]
    high = [np.log(INERTIA[1]), np.log(DAMPING[1]), LATE_S[1]]
    steps = {"x_scale": [0.1, 1.0, 0.003], "diff_step": [1e-3, 1e-2, 0.02]}
    starts = ([np.log(1500.0), np.log(5000.0), late] for late in (0.005, 0.012))
    found = [least_squares(misfit, x, bounds=(low, high), loss="soft_l1", **steps) for x in starts]
    return _coasting(min(found, key=lambda each: each.cost).x)


def _coasting(x: Array) -> Coasting:
    """x: logarithms of inertia and damping, and the delay, s."""
    inertia, damping = np.exp(x[:2])
    return Coasting(inertia=float(inertia), damping=float(damping), late_s=float(x[2]))
