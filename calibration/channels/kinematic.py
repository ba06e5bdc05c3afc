"""Differences of encoders: motor encoders against the axis (K), roller against the axis (S), auxiliary
against the axis."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.channels.frame import Frame, fill
from calibration.channels.motion import Motion
from calibration.channels.problem import Problem
from calibration.channels.torque import declared_lines, saturated, transients
from calibration.readers.drive import ARCSEC
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

STILL_S = 1.0  # without a count: the rounding of a motor's place is one error then, not one per row
# of a tachometer count: what rounding leaves when a steady speed beats with the rows (white: 0.29)
COUNT_PART = 0.1
APART_ARCSEC = 8.0  # a motor this far from where wind-up puts it has left its tooth face


@dataclass
class Kinematic:
    """The K problem (motor A's rows, then motor B's, in arcsec) and what its candidates need."""

    problem: Problem
    torque: Array  # N m at the axis through this motor's train, signed
    motor: Array
    engaged: Mask  # (n_analysis,) both motors on their tooth faces
    disengaged_driven: float  # fraction of driven rows in which a motor is off its face
    per_ampere: float  # N m at the axis


def kinematic_problem(
    frame: Frame, m: Motion, held: Mask, per_ampere: float, lines: Sequence[tuple[str, str, int]] = ()
) -> Kinematic | None:
    """Motor angle / ratio - axis angle, with an offset per run and motor; None without tachometers.

    `lines`: periodic torques that are declared; what they turn the rotors by is part of the base.
    """
    if frame.get("motor_a") is None or frame.get("motor_b") is None:
        return None
    pick, ratio = m.pick, frame.scale["gear_ratio"]
    n = len(pick)
    effort, _ = fill(frame.columns["effort"], frame.run)
    near = m.smooth(transients(frame, effort).astype(float))[pick] > 1e-9
    ys, torques, oks = [], [], []
    apart = np.zeros(n, dtype=bool)
    run = frame.run[pick]
    segment = np.cumsum(m.fresh)[pick]
    for key, sign in (("a", 1.0), ("b", -1.0)):
        spin, trusted = fill(frame.columns[f"motor_{key}"], frame.run)
        current = (
            fill(frame.columns[f"current_{key}"], frame.run)[0]
            if frame.get(f"current_{key}") is not None
            else np.zeros(len(frame.t))
        )
        angle = np.cumsum(spin) * frame.period_s / ratio - m.theta
        y = m.at(angle) / ARCSEC
        torque = sign * per_ampere * m.at(current)
        full = m.smooth(saturated(frame, current).astype(float))[pick] > 1e-9
        y, off = _off_face(y, torque, segment, m.trusted[pick] & ~near & ~full)
        apart |= off & ~full
        ys.append(y)
        torques.append(torque)
        still = standing(spin, frame.run, round(STILL_S / frame.period_s))
        oks.append((m.trusted & trusted & ~still)[pick] & ~near & ~full)
    wide = apart.copy()
    for k in range(1, 6):
        wide[k:] |= apart[:-k]
        wide[:-k] |= apart[k:]
    y, torque = np.concatenate(ys), np.concatenate(torques)
    valid = np.concatenate(oks) & ~np.concatenate([wide, wide])
    offsets = _offsets(segment, n, valid)
    alpha, rate = m.acceleration[pick], m.rate[pick]
    one = declared_lines(m, [x for x in lines if x[1] != "axis"], frame.train)
    nil = np.zeros_like(one)
    twist = np.vstack([np.hstack([one, nil]), np.hstack([nil, one])])  # the trains may differ
    base = np.column_stack(
        [
            torque / ARCSEC,
            np.concatenate([alpha, alpha]),
            np.concatenate([rate, rate]) / ARCSEC,
            twist,
            offsets,
        ]
    )
    labels = [("compliance", "rad/(N m)"), ("rotor_lag", "arcsec s2/rad"), ("tachometer_delay", "s")]
    labels += [("declared line", "arcsec")] * twist.shape[1]
    labels += [("offset", "arcsec")] * offsets.shape[1]
    problem = Problem(
        "K",
        "arcsec",
        y,
        base,
        labels,
        _twice(frame.t[pick]),
        _twice(run),
        _twice(frame.session[pick]),
        valid,
        _twice(held[pick]),
        m.period_s,
        ar_order=4,
        block_s=3.0,
        sensor="position",
        step=COUNT_PART * 1296000.0 / (frame.scale["tach_counts_per_turn"] * ratio),
        fresh=offsets,
    )
    driven = np.abs(m.at(effort)) > 0.01
    fraction = float(np.mean(apart[driven])) if driven.any() else 0.0
    motor = np.concatenate([np.zeros(n), np.ones(n)])
    return Kinematic(problem, torque, motor, ~wide, fraction, per_ampere)


def standing(spin: Array, run: NDArray[Any], rows: int) -> Mask:
    """Rows before which the motor's encoder has shown no count for more than `rows` rows."""
    index = np.arange(len(spin))
    moves = np.abs(spin) > 0
    moves[1:] |= run[1:] != run[:-1]
    last = np.maximum.accumulate(np.where(moves, index, -rows))
    return np.asarray(index - last > rows)


def _off_face(y: Array, torque: Array, segment: NDArray[Any], rows: Mask) -> tuple[Array, Mask]:
    """Centre y per segment and find rows off the wind-up line: robust line with a level per segment."""
    level = np.zeros(len(y))
    slope = 0.0
    inside = rows.copy()
    for _ in range(6):
        for s in np.unique(segment):
            at = segment == s
            use = at & inside if (at & inside).sum() > 10 else at
            level[at] = np.median((y - slope * torque)[use])
        z = y - level
        use = inside if inside.sum() > 20 else np.ones(len(y), dtype=bool)
        slope = float(np.sum(z[use] * torque[use]) / max(float(np.sum(torque[use] ** 2)), 1e-300))
        gap = np.abs(z - slope * torque)
        inside = rows & (gap < max(APART_ARCSEC, 2 * float(np.median(gap[rows])) if rows.any() else 0.0))
    return y - level, np.abs(y - level - slope * torque) > APART_ARCSEC


def _offsets(segment: NDArray[Any], n: int, valid: Mask) -> Array:
    columns = []
    for motor in (0, 1):
        for s in np.unique(segment):
            c = np.zeros(2 * n)
            c[motor * n : (motor + 1) * n] = segment == s
            if (c.astype(bool) & valid).sum() > 10:
                columns.append(c)
    return np.column_stack(columns) if columns else np.zeros((2 * n, 0))


def roller_problem(frame: Frame, m: Motion, held: Mask) -> Problem | None:
    """Incremental velocity - rate of the absolute encoder, in arcsec/s.

    Base: the counting window's delay, and its next order. The counts are those of the window at each row,
    the rate is a
    mean over all of the time between rows, and a position that was carried on to its row's time lags by a
    part of the
    acceleration: all three are a number times the jerk.
    """
    if frame.get("velocity") is None:
        return None
    velocity, trusted = fill(frame.columns["velocity"], frame.run)
    pick = m.pick
    y = (m.at(velocity) - m.rate[pick]) / ARCSEC
    effort, _ = fill(frame.columns["effort"], frame.run)
    near = m.smooth(transients(frame, effort).astype(float))[pick] > 1e-9
    jerk = np.gradient(m.acceleration, frame.period_s)
    base = np.column_stack([m.acceleration[pick], jerk[pick]]) / ARCSEC
    return Problem(
        "S",
        "arcsec/s",
        y,
        base,
        [("velocity_delay", "s"), ("window_curvature", "s2")],
        frame.t[pick],
        frame.run[pick],
        frame.session[pick],
        (m.trusted & trusted)[pick] & ~near,
        held[pick],
        m.period_s,
        ar_order=4,
        block_s=3.0,
        sensor="velocity",
    )


def auxiliary_problem(frame: Frame, m: Motion, held: Mask) -> Problem | None:
    """Auxiliary encoder - absolute encoder in arcsec, an offset per session."""
    if frame.get("aux") is None:
        return None
    aux, trusted = fill(frame.columns["aux"], frame.run)
    pick = m.pick
    raw = m.at(aux - m.theta) / ARCSEC
    run = frame.run[pick]
    offsets = np.column_stack([(run == k).astype(float) for k in np.unique(run)])
    base = np.column_stack([m.rate[pick] / ARCSEC, offsets])
    labels = [("aux_delay", "s")] + [("offset", "arcsec")] * offsets.shape[1]
    return Problem(
        "K",
        "arcsec",
        raw,
        base,
        labels,
        frame.t[pick],
        run,
        frame.session[pick],
        (m.trusted & trusted)[pick],
        held[pick],
        m.period_s,
        ar_order=4,
        block_s=3.0,
        sensor="auxiliary",
        fresh=offsets,
    )


def _twice(x: NDArray[Any]) -> NDArray[Any]:
    """Motor A's rows, then motor B's."""
    return np.concatenate([x, x])
