"""The torque residual: motor torque less inertia and declared friction, on the analysis grid."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.candidate import waves
from calibration.balances.declared import fit_friction
from calibration.balances.friction import Sliding
from calibration.balances.motion import Motion, acceleration_of
from calibration.balances.problem import Problem, Term
from calibration.inputs.declaredplant import Declared

# rows per analysis sample, 30 ms: wide enough for the encoder, enough for mesh 2 at 1.5 deg/s. ASSUMPTION
WIDTH = 3
# of a converter's count: rounding leaves 0.29, a steady current keeps its rounding for minutes. ASSUMPTION
STEP = 0.35
# of Ts / sigma_0, the bristles' longest travel: what they held before is down to a twentieth. ASSUMPTION
SLID = 3.0


#: what the declared friction's columns are sized by, and its unit
FRICTION = {
    "inertia": "kg m2",
    "viscous": "N m s/rad",
    "coulomb": "N m",
    "log_stiction": "1",
    "log_stribeck_speed": "1",
    "log_sigma_0": "1",
    "sigma_1": "N m s/rad",
}


@dataclass(frozen=True, kw_only=True)
class Transmission:
    """From currents to the axis: what electrical and encoder channels say of it.

    `per_ampere` is in N m at the axis. `left` (n,) is the part left per motor of its torque constant.
    `softness_s2` is a rotor's inertia over its train's stiffness, which takes that times the torque's second
    derivative.
    """

    per_ampere: float
    left: dict[str, Array]
    softness_s2: float
    stiffness: float  # N m/rad of one train


@dataclass(kw_only=True)
class Torque:
    """The torque problem with what it was made of."""

    problem: Problem
    friction: Sliding
    drive: Transmission


def slid(m: Motion, unseen: Array, travel: float) -> Mask:
    """Rows (n,) that lie `travel` rad of path behind the last unseen one: the bristles hold nothing of it."""
    path = np.cumsum(np.abs(np.diff(m.x, prepend=m.x[0])))
    return np.asarray(path - np.maximum.accumulate(np.where(unseen > 0, path, -np.inf)) > travel)


def declared_lines(m: Motion, lines: Sequence[tuple[str, str, int]], unit: str = "N m") -> list[Term]:
    """cos and sin (n_analysis, 2) of every declared periodic torque, dimmed by the two boxcars."""
    turns, per_row = m.x[m.rows] / (2 * np.pi), m.speed[m.rows] / (2 * np.pi) * m.frame.period_s
    out: list[Term] = []
    for _, stage, harmonic in lines:
        order = m.frame.train.orders[stage] * harmonic
        pair = m.filter.gain(per_row * order)[:, None] * waves(2 * np.pi * order * turns, (1,))
        out.append((f"declared {stage} {harmonic}", unit, pair))
    return out


def torque_problem(
    m: Motion, drive: Transmission, held: Mask, declared: Declared, beside: Array | None = None
) -> Torque | None:
    """The T channel; None without currents. `beside` (n_analysis, k): torques fitted beside friction."""
    frame, pick = m.frame, m.rows
    if frame.get("current_a") is None and frame.get("current_b") is None:
        return None
    (fa, ta), (fb, tb) = frame.filled("current_a"), frame.filled("current_b")
    left_out = [frame.transients(), frame.saturated(fa), frame.saturated(fb)]
    unseen = frame.get("unseen")
    if unseen is not None:
        left_out.append(~slid(m, unseen, SLID * declared.stiction / declared.bristle_stiffness))
    rows = (m.ok & ta & tb)[pick] & m.clear(*left_out)
    full = drive.per_ampere * (drive.left["a"] * fa - drive.left["b"] * fb)
    y = m.at(full) - drive.softness_s2 * acceleration_of(full, WIDTH, frame.period_s)[pick]
    lines = declared_lines(m, declared.lines)
    none = np.zeros((len(y), 0))
    torques = np.hstack([none, *[x for _, _, x in lines], none if beside is None else beside])
    friction, columns = fit_friction(m, y, rows & ~held[pick], declared.law, torques)
    problem = m.problem(
        held,
        [
            *((name, unit, x) for (name, unit), x in zip(FRICTION.items(), columns.T, strict=True)),
            # the currents may be late by a fraction of a row against the encoder: a nuisance, an effect only
            # when it is large
            ("current_delay", "s", m.at(np.gradient(full, frame.period_s))),
            *lines,
        ],
        channel="T",
        unit="N m",
        y=y,
        valid=rows,
        step=STEP * frame.scale["adc_A_per_count"] * drive.per_ampere,
    )
    return Torque(problem=problem, friction=friction, drive=drive)
