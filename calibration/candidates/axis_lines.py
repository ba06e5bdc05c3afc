"""Lines of the telescope drive: gear stages, motor cogging and ripple, and orders that no stage has."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.candidates.orders import order_spectrum, peaks
from calibration.channels.level import Level
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

COGGING = (
    72  # highest cogging order per motor turn that is tried; poles times slots of torque motors, ASSUMPTION
)
NEAR = 0.35  # resolution cells about a known order that are that order's
ORDER_STEP = 0.05  # of a resolution cell, for the refinement of an order
# resolution cells off a stage's order, up to NEAR, from which a line beside it may be another one: it is told
# from the stage's by its gain (decide/scan.py), this only keeps the two apart. ASSUMPTION
OFF = 0.06
FREE = 4  # free orders tried per spectrum
DAMPING = (
    0.1  # of a rotor on its train, of critical: ASSUMPTION, as the plant files' (docs of their gear damping)
)
TOP = 3000.0  # cycles per axis turn up to which an order of no shaft is looked for


@dataclass
class Motors:
    """Motor angles in turns and torques (N m at the axis, signed) on the analysis grid."""

    turns: dict[str, Array]
    torque: dict[str, Array]
    period_s: float
    softness_s2: float = 0.0  # a rotor's inertia over its train's stiffness


def pair(turns: Array, c: Context, period_s: float, weight: Array | None = None, order: float = 1.0) -> Array:
    """cos and sin of order*turns, dimmed like the analysis boxcars (twice three rows) dim a line at that
    speed."""
    cycles = np.abs(c.speed) / c.turn * order * period_s
    slow = np.where(cycles < 0.9, ((1 + 2 * np.cos(2 * np.pi * cycles / 3)) / 3) ** 2, 0.0)
    w = slow if weight is None else slow * weight
    x = 2 * np.pi * turns
    return np.column_stack([w * np.cos(x), w * np.sin(x)])


def through_train(columns: Array, c: Context, order: float, softness_s2: float) -> Array:
    """What the axis gets of a torque that acts on a rotor: cos and sin (n, 2) behind the rotor on its train,
    whose resonance a line comes near while the motor is quick. Quasi-static in the speed."""
    rate = 2 * np.pi * np.abs(c.speed) / c.turn * order
    damping = 2j * DAMPING * rate * np.sqrt(softness_s2)
    gain = (1 + damping) / (1 + damping - rate**2 * softness_s2)
    real, turned = gain.real, gain.imag * np.sign(c.speed)
    cos, sin = columns.T
    return np.column_stack([real * cos - turned * sin, turned * cos + real * sin])


def line(
    c: Context, name: str, stage: str | None, harmonic: int | None, order: float, columns: Array, domain: str
) -> Candidate:
    """A line candidate in the context's unit."""
    return Candidate(
        name,
        domain,
        columns,
        (("amplitude", c.unit),),
        kind="line",
        stage=stage,
        harmonic=harmonic,
        order=order,
    )


def gear_lines(c: Context, period_s: float) -> list[Candidate]:
    """First and second harmonic of every shaft and mesh, with what may lie beside each."""
    out = []
    turns = c.angle / c.turn
    span = float(np.ptp(turns))
    for stage in (*c.train.shafts, *c.train.meshes):
        for h in (1, 2):
            order = c.train.orders[stage] * h
            if span * order < 0.8:
                continue
            name = "gear_mesh" if stage in c.train.meshes else "gear_eccentricity"
            domain = "motor_angle" if stage == c.train.motor else "axis_angle"
            one = line(c, name, stage, h, order, pair(turns * order, c, period_s, None, order), domain)
            out.append(replace(one, neighbours=off_stage(c, order, period_s)))
    return out


def off_stage(c: Context, order: float, period_s: float) -> tuple[Candidate, ...]:
    """Lines of no shaft on either side of a stage's order, within its cell: a bearing's may lie there."""
    span = float(np.ptp(c.angle / c.turn))
    sides = [sorted(order + sign * off / span for off in (OFF, NEAR)) for sign in (-1.0, 1.0)]
    return tuple(_bearing(c, period_s, (low + high) / 2, (low, high)) for low, high in sides)


def _bearing(c: Context, period_s: float, order: float, within: tuple[float, float]) -> Candidate:
    """A line of no stage, whose order is refined `within` these bounds."""
    turns = c.angle / c.turn
    shape = _at_order(c, turns, period_s, within)
    one = line(c, "bearing_pass", None, None, order, shape(np.array([order])), "axis_angle")
    step = (ORDER_STEP / float(np.ptp(turns)),)
    return replace(one, searched=1, shape=shape, steps=step, fixed={"order": (order, "1/turn")})


def motor_lines(c: Context, motors: Motors, e: Array, rows: Mask, keep: int = 6) -> list[Candidate]:
    """Cogging (independent of current) and ripple (proportional to it) of either motor at every small order.

    Only the `keep` strongest of each kind in the residual `e` become candidates: high orders are all but
    orthogonal to
    the declared model, so that a plain projection ranks them.
    """
    found: dict[str, list[tuple[float, Candidate]]] = {"motor_cogging": [], "torque_ripple": []}
    ratio = c.train.ratio
    x = np.where(rows, e, 0.0)
    for n in range(2, COGGING + 1):
        order = n * ratio
        plain = {
            k: through_train(
                pair(motors.turns[k] * n, c, motors.period_s, None, order), c, order, motors.softness_s2
            )
            for k in "ab"
        }
        if not rows.any() or np.mean(plain["a"][:, 0] ** 2) < 0.02:
            continue
        for name in found:
            one = {
                k: v * (ratio if name == "motor_cogging" else motors.torque[k][:, None])
                for k, v in plain.items()
            }
            for motor, columns in ((0.0, one["a"]), (1.0, one["b"]), (None, np.hstack([one["a"], one["b"]]))):
                # both motors' pairs are all but the same: their angles differ by their wind-up
                q, _ = np.linalg.qr(np.where(rows[:, None], columns, 0.0))
                score = float(np.sum((q.T @ x) ** 2)) - 0.5 * float(np.var(x)) * columns.shape[1]
                made = line(c, name, c.train.motor, n, order, columns, "motor_angle")
                which = {} if motor is None else {"motor": (motor, "0 A, 1 B")}
                found[name].append((score, replace(made, labels=(LABELS[name],), fixed=which)))
    out = []
    for ranked in found.values():
        out += [k for _, k in sorted(ranked, key=lambda s: -s[0])[:keep]]
    return out


LABELS = {"motor_cogging": ("amplitude", "N m at the motor"), "torque_ripple": ("ripple", "1")}


def _between(order: float, known: Array, span: float) -> tuple[float, float]:
    """How far an order may be moved: within its resolution cell, and not to where a stage's order begins."""
    low, high = order - 0.5 / span, order + 0.5 / span
    for stage in known[np.abs(known - order) < 1.0 / span]:
        if stage >= order:
            high = min(high, float(stage) - NEAR / span)
        else:
            low = max(low, float(stage) + NEAR / span)
    return low, max(low, high)


def _at_order(
    c: Context, turns: Array, period_s: float, within: tuple[float, float]
) -> Callable[[Array], Array]:
    """A sine pair at order p[0]: between the orders of a spectrum it would leave a part to its neighbours."""

    def shape(p: Array) -> Array:
        order = float(np.clip(p[0], *within))
        return pair(turns * order, c, period_s, None, order)

    return shape


def free_lines(c: Context, level: Level, e: Array, rows: Mask, period_s: float) -> list[Candidate]:
    """The strongest orders of the residual that no stage explains: even (bearing) and odd in direction
    (friction)."""
    turns = c.angle / c.turn
    span = float(np.ptp(turns))
    known = np.array([v * h for v in c.train.known.values() for h in (1, 2, 3)])
    out = []
    sided = level.answer(np.ones(len(level.angle)))
    for name, weight in (("bearing_pass", np.ones(len(e))), ("position_friction", sided)):
        orders, power = order_spectrum(np.where(rows, e, 0.0), turns, np.where(rows, weight, 0.0), TOP)
        if name == "bearing_pass" and len(orders):
            near = np.min(np.abs(orders[:, None] - known[None, :]), axis=1) < NEAR / span
            power = np.where(near, 0.0, power)
        for order in peaks(orders, power, FREE, 1.5 / span):
            for shift in (-0.2, 0.0, 0.2):
                o = float(order + shift / span)
                if name == "bearing_pass":
                    out.append(_bearing(c, period_s, o, _between(o, known, span)))
                    continue
                x = o * level.angle
                columns = np.column_stack([level.answer(np.cos(x)), level.answer(np.sin(x))])
                out.append(line(c, name, None, None, o, columns, "axis_angle"))
    return out
