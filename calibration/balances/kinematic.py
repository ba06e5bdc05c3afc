"""Differences of encoders: the motors' against the axis (K), the roller's against the axis (S)."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import binary_dilation

from calibration.arrays import Array, Mask
from calibration.balances.filters import since
from calibration.balances.frame import Frame
from calibration.balances.motion import Motion
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_FOR_A_LEVEL, FEWEST_FOR_A_SCATTER
from calibration.balances.torque import declared_lines
from calibration.inputs.declaredplant import Declared
from plant.units import ARCSEC, ARCSEC_PER_TURN

# without a count: the rounding of a motor's place is one error then, not one per row. ASSUMPTION
STILL_S = 1.0
# of a tachometer count: rounding where a steady speed beats with the rows (white: 0.29). ASSUMPTION
COUNT_PART = 0.1
APART_ARCSEC = 8.0  # a motor this far from where wind-up puts it has left its tooth face. ASSUMPTION
NEAR = 5  # rows of the analysis grid on either side of such a one, that are left out too. ASSUMPTION
KNOWN = 0.05  # standard error of the wind-up, of itself, up to which the measured one is used. ASSUMPTION
SPREAD = 5.0  # factor either way beyond which it is not a train's. ASSUMPTION


@dataclass(frozen=True, kw_only=True)
class Kinematic:
    """The K problem (motor A's rows, then motor B's, in arcsec), and what the torque needs of it."""

    problem: Problem
    engaged: Mask  # (n_analysis,) both motors on their tooth faces
    per_ampere: float  # N m at the axis


def kinematic_problem(
    frame: Frame, m: Motion, held: Mask, per_ampere: float, lines: Sequence[tuple[str, str, int]] = ()
) -> Kinematic | None:
    """Motor angle / ratio - axis angle, with an offset per run and motor; None without tachometers.

    `lines`: periodic torques that are declared; what they turn the rotors by is part of the base.
    """
    if frame.get("motor_a") is None or frame.get("motor_b") is None:
        return None
    pick, ratio = m.rows, frame.scale["gear_ratio"]
    near = ~m.clear(frame.transients())
    ys, torques, oks = [], [], []
    apart = np.zeros(len(pick), dtype=bool)
    segment = np.cumsum(m.fresh)[pick]
    for key, sign in (("a", 1.0), ("b", -1.0)):
        spin, trusted = frame.filled(f"motor_{key}")
        current, _ = frame.filled(f"current_{key}")
        angle = np.cumsum(spin) * frame.period_s / ratio - m.x
        y = m.at(angle) / ARCSEC
        torque = sign * per_ampere * m.at(current)
        full = ~m.clear(frame.saturated(current))
        y, off = _off_face(y, torque, segment, m.ok[pick] & ~near & ~full)
        apart |= off & ~full
        ys.append(y)
        torques.append(torque)
        still = standing(spin, frame.run, round(STILL_S / frame.period_s))
        oks.append((m.ok & trusted & ~still)[pick] & ~near & ~full)
    engaged = ~binary_dilation(apart, iterations=NEAR)
    valid = np.concatenate(oks) & np.tile(engaged, 2)
    label = np.concatenate([segment, segment + segment[-1] + 1])
    offsets = (label[:, None] == np.unique(label)).astype(float)
    offsets = offsets[:, valid @ offsets > FEWEST_FOR_A_LEVEL]
    twists = declared_lines(m, [x for x in lines if x[1] != "axis"], "arcsec")
    # trains may differ
    each = [(name, unit, np.kron(np.eye(2), one).astype(float)) for name, unit, one in twists]
    problem = m.problem(
        held,
        [
            ("compliance", "rad/(N m)", np.concatenate(torques) / ARCSEC),
            ("rotor_lag", "arcsec s2/rad", np.tile(m.acceleration[pick], 2)),
            ("tachometer_delay", "s", np.tile(m.speed[pick], 2) / ARCSEC),
            *each,
            ("offset", "arcsec", offsets),
        ],
        channel="K",
        unit="arcsec",
        y=np.concatenate(ys),
        valid=valid,
        step=COUNT_PART * ARCSEC_PER_TURN / (frame.scale["tach_counts_per_turn"] * ratio),
        fresh=offsets,
    )
    return Kinematic(problem=problem, engaged=engaged, per_ampere=per_ampere)


def standing(spin: Array, run: NDArray[Any], rows: int) -> Mask:
    """Rows before which the motor's encoder has shown no count for more than `rows` rows."""
    moves = np.abs(spin) > 0
    moves[1:] |= run[1:] != run[:-1]
    return since(moves, before=rows) > rows


def _off_face(y: Array, torque: Array, segment: NDArray[Any], rows: Mask) -> tuple[Array, Mask]:
    """Centre y per segment and find rows off the wind-up line: robust line with a level per segment."""
    level = np.zeros(len(y))
    slope = 0.0
    inside = rows.copy()
    for _ in range(6):
        for s in np.unique(segment):
            at = segment == s
            use = at & inside if (at & inside).sum() > FEWEST_FOR_A_LEVEL else at
            level[at] = np.median((y - slope * torque)[use])
        z = y - level
        use = inside if inside.sum() > FEWEST_FOR_A_SCATTER else np.ones(len(y), dtype=bool)
        slope = float(np.sum(z[use] * torque[use]) / max(float(np.sum(torque[use] ** 2)), 1e-300))
        gap = np.abs(z - slope * torque)
        inside = rows & (gap < max(APART_ARCSEC, 2 * float(np.median(gap[rows])) if rows.any() else 0.0))
    return y - level, np.abs(y - level - slope * torque) > APART_ARCSEC


def wind_up(frame: Frame, m: Motion, held: Mask, declared: Declared) -> float:
    """rad of the axis that an ampere winds a train up by; the declared one where encoders do not tell."""
    per_ampere = declared.torque_constant * frame.scale["gear_ratio"]
    as_declared = per_ampere / declared.stiffness
    k = kinematic_problem(frame, m, held, per_ampere, declared.lines)
    if k is None or frame.get("current_a") is None or k.problem.train.sum() < 10 * k.problem.block:
        return as_declared
    found = k.problem.named(k.problem.fit())["compliance"]
    likely = 1 / SPREAD < found.value * declared.stiffness < SPREAD
    return found.value * per_ampere if likely and found.error < KNOWN * found.value else as_declared


def roller_problem(frame: Frame, m: Motion, held: Mask) -> Problem | None:
    """Incremental velocity - rate of the absolute encoder, in arcsec/s.

    Base: the counting window's delay, and its next order. Counts of a window, a mean over rows and a position
    carried on to its row differ by a number times the jerk.
    """
    if frame.get("velocity") is None:
        return None
    velocity, trusted = frame.filled("velocity")
    pick, jerk = m.rows, np.gradient(m.acceleration, frame.period_s)
    delay, curvature = m.acceleration[pick] / ARCSEC, jerk[pick] / ARCSEC
    terms = [("velocity_delay", "s", delay), ("window_curvature", "s2", curvature)]
    y, valid = (m.at(velocity) - m.speed[pick]) / ARCSEC, m.clear(frame.transients())
    valid &= (m.ok & trusted)[pick]
    return m.problem(held, terms, channel="S", unit="arcsec/s", y=y, valid=valid)
