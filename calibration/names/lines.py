"""Lines over a place: the harmonics of a stage, of one drive's or of either motor's train, and the orders of
a motor. A line is the sine pair of some cycles per position unit, through the filter of its balance."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.finding import UNKNOWN, Finding
from calibration.inputs.declaration import Stage
from calibration.names.inplant import SIDES, Facts, Made, motor_of, value
from calibration.names.name import Size, candidate
from calibration.names.scene import MOTOR, Scene
from calibration.statistics.orders import PER_ROW, Wanted, standing_out

ENOUGH = 1.2  # turns of a line needed before its two coefficients mean anything. ASSUMPTION
AXIS_ENOUGH = 0.8  # turns likewise, on an axis whose position is absolute. ASSUMPTION
MANY_ENOUGH = 0.5  # turns likewise, of a stage with many harmonics, whose others turn more often. ASSUMPTION
# cycles likewise, of a stage that does not come round: fewer are any function of the place. ASSUMPTION
NOT_ROUND = 2.0
SAME = 1e-6  # of a turn: orders that are one. arithmetic
OWN = 0.35  # part of a resolution cell (1 / travel) about a stage's harmonic that is its own. ASSUMPTION
OFF = 0.05  # part of such a cell, from where on a line may be none of the stage's. ASSUMPTION
AROUND = 4  # lines of no stage that are tried beside a stage's. ASSUMPTION
SEEN = 0.3  # share of the fitted rows that must see a line. ASSUMPTION
# cycles, rms, by which the turn and the clock run apart before a log tells a line over one from a line over
# the other: a quarter of a sine's mean square (2 pi 0.1)^2 / 2 is left. arithmetic
SLIP = 0.1
ON_CLOCK = 3  # strongest lines on the clock that are tried of an axis with two motors. ASSUMPTION
SLOWEST_HZ = 0.05  # Hz of such a line, at least. ASSUMPTION: slower, it is a smooth function of time
CLOCKED = "command_disturbance"  # what a line over the place is called when the clock drives it
# cycles within the travel before a line that no stage has is a line and not a bend. ASSUMPTION
FREE_TURNS = 5.0
# harmonics of a stage that are also looked for as one: slots show up to their fourth multiple. ASSUMPTION
TOGETHER = 24
STEP_OF_CELL = 0.1  # part of a line's resolution cell, for its refinement. ASSUMPTION
# highest order per motor turn that is tried; poles times slots of torque motors, ASSUMPTION
MOTOR_ORDERS = 72
# part of critical, of a rotor on its train. ASSUMPTION, as the plant files' (docs of their gear damping)
DAMPING = 0.1
KEEP = 6  # orders of a kind that become candidates. ASSUMPTION
# share that the filter leaves of a column's mean square: less, and the drive is too quick. ASSUMPTION
LEAST = 0.02
BY_CHANCE = 0.5  # share of the residual's mean square that a column takes by chance. ASSUMPTION


def line(s: Scene, name: str, rate: float, size: Size = "", **more: Any) -> Candidate:
    """A line of `rate` cycles per position unit that has no columns yet; `more`: `Candidate`'s fields."""
    none, size = np.zeros((len(s.view.rows), 0)), size or ("amplitude", s.unit)
    return candidate(name, none, size, kind="line", order=float(rate * s.turn), **more)


def stage_lines(s: Scene, kind: str, default: bool = False, of: str = "") -> list[Candidate]:
    """A sine pair at every harmonic of every stage of this kind that the log travels far enough for.
    `default`: stages without a kind, too. `of`: stages of that kind, whose own name the log cannot show."""
    out = []
    for stage in s.view.rig.stages:
        if stage.period is None or (stage.declared or (kind if default else "")) != (of or kind):
            continue
        of_motor = s.pair is not None and stage.name == s.pair.train.motor
        blank = line(s, kind, 0.0, twins=(of,) if of else ())
        mine = of_stage(s, stage, replace(blank, domain="motor_angle") if of_motor else blank)
        out += _of_rig(s, stage, mine) if s.pair is None else _of_axis(s, mine)
    return out


def on_clock(s: Scene, rate: float) -> float:
    """Hz of `rate` cycles per position unit where the log's one speed hardly tells the two; else 0."""
    speed, slip = s.one_speed
    return abs(rate * speed) if rate * slip < SLIP else 0.0


def has_train(s: Scene) -> bool:
    """Whether the rig file has the train: a stage that is the motor, or that turns quicker than the axis."""

    def within(g: Stage) -> bool:
        quicker = s.view.turn is None or (g.period or s.turn) < s.turn * (1 - SAME)
        return g.period is not None and (quicker or g.of_motor)

    return any(within(g) for g in s.view.rig.stages)


def of_stage(
    s: Scene, stage: Stage, blank: Candidate, weight: Array | None = None, turns: float | None = None
) -> list[Candidate]:
    """`blank` at the stage's harmonics that make `turns` within the travel; `weight` (n,) at full rate."""
    enough = AXIS_ENOUGH if s.pair is not None else ENOUGH if stage.harmonics <= 2 else MANY_ENOUGH
    if s.pair is None and s.force and stage.period and s.span < stage.period:
        enough = NOT_ROUND
    out = []
    for h in stage.orders if stage.period else ():
        rate = h / (stage.period or 1.0)
        if s.span * rate >= (turns or enough) and seen(s, rate):
            twins = (*blank.twins, *([CLOCKED] if on_clock(s, rate) else []))
            one = replace(blank, stage=stage.name, harmonic=h, order=rate * s.turn, twins=twins)
            out += over_place(s, one, rate, weight)
    return out


def _of_rig(s: Scene, stage: Stage, mine: list[Candidate]) -> list[Candidate]:
    """Also all harmonics as one. A bearing's line may lie beside any of them."""
    beside, weighs = beside_stage(s, stage), s.force and s.view.turn is not None
    # once per turn of an angle: a weight that hangs off it has the same columns
    others = [c for c in mine if not weighs or abs((c.order or 0.0) - 1) >= SAME or c.per_run]
    whole, turns = as_one(mine), s.span / (stage.period or s.span)
    if turns < 1:  # nothing comes again: together they are any function of the place, and so called
        whole = [] if s.force else [replace(c, name=UNKNOWN, twins=(c.name, *c.twins)) for c in whole]
    return [replace(c, neighbours=beside) for c in [*others, *whole]]


def _of_axis(s: Scene, mine: list[Candidate]) -> list[Candidate]:
    """A torque's lines beside others on both sides; encoders see a twist of both trains alike, or of one."""
    if s.force:
        return [replace(c, neighbours=_sides(s, c)) for c in mine]
    weights = [np.ones(len(s.problem.y)), *(rows for rows, motor in s.motors if motor)]
    return [replace(c, columns=c.columns * w[:, None]) for c in mine for w in weights]


def _sides(s: Scene, c: Candidate) -> tuple[Candidate, ...]:
    """Lines of no stage on either side of a stage's, within its cell: a bearing's may lie there."""
    rate = float(c.order or 0.0) / s.turn
    sides = [sorted(rate + sign * off / s.span for off in (OFF, OWN)) for sign in (-1.0, 1.0)]
    return tuple(k for low, high in sides for k in movable(s, (low + high) / 2, (low, high)))


def beside_stage(s: Scene, stage: Stage) -> tuple[Candidate, ...]:
    """Lines of no stage that stand out within the cells of a stage's orders, but off them."""
    own = np.array(stage.orders) / (stage.period or 1.0)
    found = peaks_over_place(s, AROUND) if s.span > 0 else []
    out: list[Candidate] = []
    for rate in (r for r in found if seen(s, r)):
        nearest = float(own[np.argmin(np.abs(rate - own))])
        low, high = sorted(nearest + np.sign(rate - nearest) * off / s.span for off in (OFF, OWN))
        out += movable(s, rate, (low, high)) if low < rate < high else []
    return tuple(out)


def over_place(s: Scene, blank: Candidate, rate: float, weight: Array | None = None) -> list[Candidate]:
    """`blank` with the sine pair of `rate` cycles per position unit, its phase bound to the place. It comes
    also with a phase of every file's own where the files' zeros may differ. `weight` is at full rate."""
    phase = 2 * np.pi * rate * s.view.x
    w = 1.0 if weight is None else weight
    pair = s.at(np.column_stack([w * np.cos(phase), w * np.sin(phase)]))
    passes = s.view.filter.gain(s.view.speed[s.view.rows] * rate * s.view.period_s)
    pair = pair * (passes > 0)[:, None]  # elsewhere a log has nothing of the line, and its columns alias
    zeros = ((np.hstack([pair * rows[:, None] for rows in parts]), own) for parts, own in s.zeros)
    return [replace(blank, columns=columns, per_run=own) for columns, own in zeros]


def as_one(mine: list[Candidate]) -> list[Candidate]:
    """Several large harmonics of a stage, one by one, hide each other: all of one zero as one."""
    out = []
    for own in (False, True):
        some = [c for c in mine if c.per_run == own][:TOGETHER]
        if len(some) > 1:
            whole = np.hstack([c.columns for c in some])
            out.append(replace(some[0], columns=whole, harmonic=None, searched=1))
    return out


def seen(s: Scene, rate: float) -> bool:
    """Whether enough rows move less than PER_ROW periods per sample and filter; a pair's columns tell."""
    if s.pair is not None:
        return True
    step = s.view.period_s * max(s.view.step, s.view.sigma)
    return bool(np.mean(np.abs(s.view.speed[s.view.rows]) * rate * step < PER_ROW) > SEEN)


def peaks_over_place(s: Scene, most: int) -> list[float]:
    """Rates (cycles per position unit) at which the residual's spectrum over the position stands out."""
    return spectral_lines(s, s.view.x[s.view.rows], Wanted(span=s.span, least=FREE_TURNS / s.span, most=most))


def spectral_lines(s: Scene, z: Array, want: Wanted) -> list[float]:
    """Frequencies over z (n_fitted,) where the residual's spectrum stands out."""
    rows = s.problem.train
    return standing_out(s.residual[rows], z[rows], s.problem.session[rows], want)


def cell(rate: float, span: float) -> tuple[float, float]:
    """The rates that a travel does not tell from this one."""
    return rate - 0.5 / span, rate + 0.5 / span


def movable(s: Scene, rate: float, within: tuple[float, float]) -> list[Candidate]:
    """A line of no stage at `rate` cycles per position unit, whose order may move `within` these bounds.
    Where the drive is at some places more often than at others, the spectrum's peak lies beside it."""
    at = {"order": (float(rate * s.turn), "1/turn" if s.view.turn else f"1/{s.angle_unit}")}
    step = (STEP_OF_CELL * s.turn / s.span,)
    twins = (CLOCKED,) if on_clock(s, rate) else ()
    blank = line(s, "bearing_pass", rate, apart=float(rate), searched=1, fixed=at, steps=step, twins=twins)

    def with_shape(c: Candidate) -> Candidate:
        def shape(p: Array) -> Array:
            return next(k.columns for k in over_place(s, c, float(p[0] / s.turn)) if k.per_run == c.per_run)

        return replace(c, shape=shape, within=(within[0] * s.turn, within[1] * s.turn))

    return [with_shape(c) for c in over_place(s, blank, rate)]


def _waves(s: Scene, turns: Array, order: float) -> Array:
    """What the axis gets of a torque on a rotor: its cos and sin (n, 2) at `order` per axis turn. The
    torque's angle has made `turns` periods. The filter dims the wave. The rotor on its train turns it: a line
    comes near their resonance while the motor is quick. Quasi-static in the speed."""
    assert s.pair is not None
    speed = np.asarray(s.view.speed[s.view.rows] / s.turn)
    dim, softness = s.view.filter.gain(speed * order * s.view.period_s), s.pair.softness_s2
    rate = 2 * np.pi * np.abs(speed) * order
    damping = 2j * DAMPING * rate * np.sqrt(softness)
    gain = dim * (1 + damping) / (1 + damping - rate**2 * softness)
    turned = gain.real + 1j * gain.imag * np.sign(speed)
    wave = turned * np.exp(2j * np.pi * turns)
    return np.column_stack([wave.real, wave.imag])


def motor_lines(s: Scene, name: str, size: Size, weights: tuple[Array, ...]) -> list[Candidate]:
    """A line of motor A, of motor B, and of both at every small order; `weights` (n_fitted,) of A and B.

    Only the KEEP strongest in the residual become candidates. High orders are all but orthogonal to the
    declared model, so that a plain projection ranks them.
    """
    assert s.pair is not None
    rows, train = s.problem.train, s.pair.train
    x = np.where(rows, s.residual, 0.0)
    found: list[tuple[float, Candidate]] = []
    for n in range(2, MOTOR_ORDERS + 1):
        order = n * train.ratio
        plain = [_waves(s, turns * n, order) for turns in s.pair.turns]
        if not rows.any() or np.mean(plain[0][:, 0] ** 2) < LEAST:
            continue
        a, b = (p * w[:, None] for p, w in zip(plain, weights, strict=True))
        blank = line(s, name, order / s.turn, size, stage=train.motor, harmonic=n)
        # both motors' pairs are all but the same: their angles differ by their wind-up
        for motor, columns in ((1.0, a), (2.0, b), (None, np.hstack([a, b]))):
            q, _ = np.linalg.qr(np.where(rows[:, None], columns, 0.0))
            score = float(np.sum((q.T @ x) ** 2)) - BY_CHANCE * float(np.var(x)) * columns.shape[1]
            fixed = {} if motor is None else {"motor": (motor, MOTOR)}
            found.append((score, replace(blank, columns=columns, fixed=fixed)))
    return [c for _, c in sorted(found, key=lambda f: -f[0])[:KEEP]]


def over_motor(f: Finding, facts: Facts, size: str, turn: float) -> Made:
    """In a plant file, over the angle of a motor, which lies half the play off the axis'. `turn` is in rad
    from the residual's phase to the plant's. A finding without a motor has motor A's wave first and motor B's
    second.
    """
    made, number, cycles = Made(), motor_of(f), float(f.harmonic or 1)
    second = f"{size}_2" in f.parameters
    for motor, word in ((1, ""), (2, "_2")) if not number and second else ((number, ""),):
        phase = value(f, "phase" + word) + turn - cycles * SIDES[motor] * facts.half_play
        values = {"cycles": cycles, size: value(f, size + word), "phase": phase}
        made.add(f.name, facts, values | {"motor": float(motor)})
    if not number and not second:
        made.remarks.append(f"{f.name}: the log does not say on which motor, written to both")
    return made
