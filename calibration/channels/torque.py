"""The torque residual: motor torque less inertia and declared friction, on the analysis grid."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.candidates.context import Context, direction_of, since_reversal
from calibration.channels.declared import Friction, fit_friction
from calibration.channels.frame import Frame, fill
from calibration.channels.motion import Motion, motion_of
from calibration.channels.problem import Problem
from calibration.declaredplant import Declared
from calibration.inputs.train import Train
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

WIDTH = (
    3  # rows per analysis sample: 30 ms, wide enough for the encoder, narrow enough for mesh 2 at 1.5 deg/s
)
# of full effort within one row: an electrical and gear transient that the rigid balance does not hold
STEP = (
    0.35  # of a converter's count: rounding leaves 0.29, and a steady current keeps its rounding for minutes
)
JUMP = 0.02
SETTLE_S = 0.25  # how long such a transient lasts: a few turns of the lock-rotor mode and of the PI loop
SLID = 3.0  # of Ts / sigma_0, the bristles' longest travel: what they held before is down to a twentieth
DIRECTION_TRAVEL = 2e-6  # rad, 0.4 arcsec: more than the encoder's noise, less than the pre-sliding range


@dataclass(frozen=True)
class Transmission:
    """From currents to the axis: what electrical and encoder channels say of it.

    `per_ampere` N m at the axis; `left` (n,) per motor, the part of its torque constant it has left;
    `softness_s2` is a rotor's inertia at the axis over its train's stiffness: what the rotors turn against
    the axis while the trains wind up takes that times the torque's second derivative.
    """

    per_ampere: float
    left: dict[str, Array]
    softness_s2: float
    stiffness: float  # N m/rad of one train


@dataclass
class Torque:
    """The torque problem with what it was made of."""

    problem: Problem
    context: Context
    motion: Motion
    friction: Friction
    bristle: Array  # F/Tc at full rate
    drive: Transmission


def transients(frame: Frame, effort: Array) -> Mask:
    """Rows within SETTLE_S after a jump of the effort, or two rows before it."""
    jump = np.zeros(len(effort), dtype=bool)
    jump[1:] = (np.abs(np.diff(effort)) > JUMP) & (frame.run[1:] == frame.run[:-1])
    count = round(SETTLE_S / frame.period_s)
    last = np.where(jump, np.arange(len(jump)), -(10**9))
    np.maximum.accumulate(last, out=last)
    near = np.arange(len(jump)) - last <= count
    near[:-1] |= jump[1:]
    near[:-2] |= jump[2:]
    return np.asarray(near)


def slid(m: Motion, unseen: Array, travel: float) -> Mask:
    """Rows (n,) that lie `travel` rad of path behind the last unseen one: the bristles hold nothing of it."""
    path = np.cumsum(np.abs(np.diff(m.theta, prepend=m.theta[0])))
    return np.asarray(path - np.maximum.accumulate(np.where(unseen > 0, path, -np.inf)) > travel)


def saturated(frame: Frame, current: Array) -> Mask:
    """Rows where the current's converter is at its end."""
    return np.asarray(current >= frame.scale["adc_end_A"])


def declared_lines(m: Motion, lines: Sequence[tuple[str, str, int]], train: Train) -> Array:
    """(n_analysis, 2 k): cos and sin of every declared periodic torque, dimmed by the two boxcars."""
    turns, speed = m.theta[m.pick] / (2 * np.pi), np.abs(m.rate[m.pick]) / (2 * np.pi)
    columns = [np.zeros((len(turns), 0))]
    for _, stage, harmonic in lines:
        order = train.orders[stage] * harmonic
        per_sample = speed * order * m.period_s
        dim = np.where(per_sample < 0.9, np.sinc(per_sample) ** 2, 0.0)
        x = 2 * np.pi * order * turns
        columns.append(np.column_stack([dim * np.cos(x), dim * np.sin(x)]))
    return np.hstack(columns)


def torque_problem(
    frame: Frame,
    drive: Transmission,
    held: Mask,
    declared: Declared,
    beside: Array | None = None,
) -> Torque | None:
    """Build the T channel; None when the log has no currents. `held` (n,) marks held-out rows at full
    rate; `beside` (n_analysis, k) are torques fitted beside friction, and no part of the base."""
    ia, ib = frame.get("current_a"), frame.get("current_b")
    if ia is None and ib is None:
        return None
    zero = np.zeros(len(frame.t))
    fa, ta = fill(ia, frame.run) if ia is not None else (zero, np.ones(len(zero), dtype=bool))
    fb, tb = fill(ib, frame.run) if ib is not None else (zero, np.ones(len(zero), dtype=bool))
    effort, _ = fill(frame.columns["effort"], frame.run)
    m = motion_of(frame, WIDTH)
    near = transients(frame, effort)
    pick = m.pick
    near |= saturated(frame, fa) | saturated(frame, fb)
    unseen = frame.get("unseen")
    if unseen is not None:
        near |= ~slid(m, unseen, SLID * declared.stiction / declared.sigma_0)
    rows = (m.trusted & ta & tb)[pick] & (m.smooth(near.astype(float))[pick] < 1e-9)
    full = drive.per_ampere * (drive.left["a"] * fa - drive.left["b"] * fb)
    y = m.at(full) - drive.softness_s2 * m.curvature(full)[pick]
    test = held[pick]
    lines = declared_lines(m, declared.lines, frame.train)
    torques = lines if beside is None else np.hstack([lines, beside])
    friction, base, bristle = fit_friction(
        m, y, rows & ~test, declared.start, declared.stribeck_exponent, torques
    )
    labels = [
        ("inertia", "kg m2"),
        ("viscous", "N m s/rad"),
        ("coulomb", "N m"),
        ("log_stiction_ratio", "1"),
        ("log_stribeck_speed", "1"),
        ("log_stiffness", "1"),
        ("sigma_1", "N m s/rad"),
    ]
    # the currents may be late by a fraction of a row against the encoder: a nuisance, an effect only when
    # it is large
    base = np.column_stack([base, m.at(np.gradient(full, frame.period_s))])
    labels.append(("current_delay", "s"))
    base = np.hstack([base, lines])
    labels += [(f"declared {s} {h}", "N m") for _, s, h in declared.lines for _ in "cs"]
    t = frame.t[pick]
    problem = Problem(
        "T",
        "N m",
        y,
        base,
        labels,
        t,
        frame.run[pick],
        frame.session[pick],
        rows,
        test,
        m.period_s,
        ar_order=4,
        block_s=3.0,
        step=STEP * frame.scale["adc_A_per_count"] * drive.per_ampere,
    )
    theta = m.theta[pick]
    direction = direction_of(theta, frame.run[pick], DIRECTION_TRAVEL)
    rate = m.rate[pick]
    temperature = frame.get("temperature")
    context = Context(
        t,
        theta,
        rate,
        direction,
        since_reversal(theta, direction, frame.run[pick]),
        frame.run[pick],
        frame.session[pick],
        "N m",
        "rad",
        2 * np.pi,
        np.abs(m.at(np.abs(bristle))) * friction.coulomb,
        load=y,
        current=m.at(fa - fb),
        effort=m.at(effort),
        temperature=fill(temperature, frame.run)[0][pick] if temperature is not None else None,
        stages={k: v / (2 * np.pi) for k, v in frame.train.known.items()},
        train=frame.train,
    )
    return Torque(problem, context, m, friction, bristle, drive)
