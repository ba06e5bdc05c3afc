"""Lines over position or time: columns for the names that are one, and the search for those nobody
declared."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.scene import Scene
from calibration.readers.run import Array

ENOUGH = 1.2  # turns of a line needed before its two coefficients mean anything
SAME = 1e-6  # of a turn
OWN = 0.35  # resolution cells (1 / travel) about a stage's harmonic that are its own, as on the axis
OFF, AROUND = (
    0.05,
    4,
)  # of such a cell, from where on a line may be none of the stage's; lines tried, likewise
PER_ROW = 0.45  # of a period per fitted row at most: quicker is not seen
FREE_TURNS = 5.0  # cycles within the travel before a line that no stage has is a line and not a bend
TOGETHER = 24  # harmonics of a stage that are also looked for as one: slots show up to their fourth multiple
STANDS_OUT = 12.0  # times the spectrum around it, in power
# of the residual's mean square: a line that takes as much needs to stand out less, because the filter, which
# takes more of it where the drive is quick, spreads it over its neighbours. ASSUMPTION: a line is only
# offered here, what it is worth is decided on rows that were not fitted
LARGE, LARGE_STANDS_OUT = 0.05, 5.0
STEP_OF_CELL = 0.1  # of a line's resolution cell, for its refinement
HIGHEST = 4000  # cycles within the travel that are searched


def stage_lines(s: Scene, kind: str, default: bool = False) -> list[Candidate]:
    """A sine pair per session at every harmonic of every stage of this kind that the log travels far enough
    for; `default`: stages without a kind, too."""
    out = []
    x = s.view.x[s.view.rows]
    for stage in s.view.rig.stages:
        if stage.period is None or (stage.kind or (kind if default else "")) != kind:
            continue
        for h in range(1, stage.harmonics + 1):
            rate = h / stage.period
            if (s.span * rate < ENOUGH and stage.harmonics < 3) or s.span * rate < 0.5 or not seen(s, rate):
                continue
            out += over_place(
                s,
                Candidate(
                    kind,
                    "motor_angle" if kind in ("motor_cogging", "torque_ripple") else "axis_angle",
                    np.zeros((len(x), 0)),
                    (("amplitude", s.unit),),
                    kind="line",
                    stage=stage.name,
                    harmonic=h,
                    order=rate * (s.view.turn or 1.0),
                ),
                rate,
            )
        mine = [c for c in out if c.stage == stage.name]
        out = [c for c in out if not _is_weight(s, c)] + as_one(mine)
        beside = tuple(_off_stage(s, [h / stage.period for h in range(1, stage.harmonics + 1)]))
        out = [replace(c, neighbours=beside) if c.stage == stage.name else c for c in out]
    return out


def _off_stage(s: Scene, orders: list[float]) -> list[Candidate]:
    """Lines of no stage within the cells of a stage's orders (cycles per position unit), but off them: a
    bearing's may lie there."""
    if s.span <= 0:
        return []
    found = peaks(s, s.view.x[s.view.rows], s.span, FREE_TURNS / s.span, AROUND)
    off = {rate: min(abs(rate - r) * s.span for r in orders) for rate in found}
    return [c for rate, by in off.items() if OFF < by < OWN and seen(s, rate) for c in _free(s, rate)]


def _is_weight(s: Scene, c: Candidate) -> bool:
    """Once per turn of an angle: gravity_imbalance has the same columns."""
    return s.force and s.view.turn is not None and abs((c.order or 0.0) - 1) < SAME and not c.per_run


def over_place(s: Scene, blank: Candidate, rate: float, weight: Array | None = None) -> list[Candidate]:
    """`blank` with the sine pair of `rate` cycles per position unit, its phase bound to the place; and with
    a phase of every file's own where the files' zeros may differ. `weight` is at full rate."""
    phase = 2 * np.pi * rate * s.view.x
    w = 1.0 if weight is None else weight
    pair = s.at(np.column_stack([w * np.cos(phase), w * np.sin(phase)]))
    return [
        replace(
            blank, columns=np.hstack([pair * (label == k)[:, None] for k in np.unique(label)]), per_run=own
        )
        for label, own in s.zeros
    ]


def as_one(mine: list[Candidate]) -> list[Candidate]:
    """Several large harmonics of a stage hide each other when they are taken one by one: all of one zero as
    one."""
    out = []
    for own in (False, True):
        some = [c for c in mine if c.per_run == own][:TOGETHER]
        if len(some) > 1:
            whole = np.hstack([c.columns for c in some])
            out.append(replace(some[0], columns=whole, harmonic=None, searched=1))
    return out


def seen(s: Scene, rate: float) -> bool:
    """False when most rows move more than PER_ROW of the line's period per sample or within the filter."""
    step = s.view.period_s * max(s.view.step, s.view.sigma)
    return bool(np.mean(np.abs(s.view.speed[s.view.rows]) * rate * step < PER_ROW) > 0.3)


def free_lines(s: Scene, most: int = 6) -> list[Candidate]:
    """Lines over position at no stage's period that stand out of the residual's spectrum."""
    x = s.view.x[s.view.rows]
    taken = [h / g.period for g in s.view.rig.stages if g.period for h in range(1, max(g.harmonics, 3) + 1)]
    if s.span <= 0:
        return []
    found = peaks(s, x, s.span, FREE_TURNS / s.span, most)
    clear = [f for f in found if all(abs(f - r) * s.span >= OWN for r in taken) and seen(s, f)]
    return [c for rate in clear for c in _free(s, rate)]


def _free(s: Scene, rate: float) -> list[Candidate]:
    """A line of no stage at `rate` cycles per position unit."""
    blank = Candidate(
        "bearing_pass",
        "axis_angle",
        np.zeros((len(s.view.rows), 0)),
        (("amplitude", s.unit),),
        kind="line",
        order=float(rate * (s.view.turn or 1.0)),
        apart=float(rate),
        searched=1,
    )
    return [_movable(s, c, rate) for c in over_place(s, blank, rate)]


def _movable(s: Scene, c: Candidate, rate: float) -> Candidate:
    """The line with an order that may move within its resolution cell: where the drive is at some places more
    often than at others, the spectrum's peak lies beside it."""
    turn = s.view.turn or 1.0

    def shape(p: Array) -> Array:
        near = float(np.clip(p[0] / turn, rate - 0.5 / s.span, rate + 0.5 / s.span))
        return next(k.columns for k in over_place(s, c, near) if k.per_run == c.per_run)

    order = {"order": (rate * turn, "1/turn" if s.view.turn else f"1/{s.angle_unit}")}
    return replace(c, shape=shape, steps=(STEP_OF_CELL * turn / s.span,), fixed=order)


def peaks(
    s: Scene,
    z: Array,
    span: float,
    least: float,
    most: int,
    avoid: Array | None = None,
    large_first: bool = False,
) -> list[float]:
    """Frequencies over z (cycles per unit of z, `least` and up) where the residual's spectrum stands out,
    summed over sessions; those of `avoid` left out. `large_first`: a square's fundamental stands out less
    than its overtones, because its own flanks are around it."""
    train = s.problem.train
    top = HIGHEST / span
    step = np.abs(np.diff(z[train]))
    usual = float(np.median(step[step > 0])) if (step > 0).any() else 0.0
    if usual > 0:
        top = min(top, PER_ROW / usual)
    if top <= 2 * least:
        return []
    power, energy = np.zeros(0), 0.0
    low = float(z[train].min())
    cells = int(min(np.ceil(span * top * 8), 2**21))
    size = 1 << int(np.ceil(np.log2(max(2 * cells, 16))))
    width = span / cells
    for k in np.unique(s.problem.session[train]):
        rows = train & (s.problem.session == k)
        cell = np.clip(((z[rows] - low) / width).astype(np.int64), 0, cells - 1)
        binned = np.bincount(cell, s.residual[rows], minlength=cells)
        one = np.abs(np.fft.rfft(binned, size)) ** 2 / max(int(rows.sum()), 1)
        power = one if len(power) == 0 else power + one
        energy += float(np.sum(s.residual[rows] ** 2))
    f = np.arange(len(power)) / (size * width)
    use = (f >= least) & (f <= top)
    if avoid is not None:
        use &= ~np.isin(np.arange(len(f)), np.flatnonzero(avoid_mask(f, avoid, 0.75 / span)))
    ratio = power / np.maximum(_around(power, max(int(12 * size * width / span), 8)), 1e-300)
    ratio[~use] = 0.0
    large = 2 * power > LARGE * energy  # of a sine of amplitude A: A^2 / 2 over the mean square
    found: list[float] = []
    first = ~large if large_first else np.zeros(len(f), dtype=bool)
    for k in np.lexsort((-ratio, first, ratio < LARGE_STANDS_OUT))[: 60 * most]:
        if ratio[k] < LARGE_STANDS_OUT or len(found) >= most:
            break
        if ratio[k] < STANDS_OUT and not large[k]:
            continue
        top_of = 0 < k < len(ratio) - 1 and power[k] >= power[k - 1] and power[k] >= power[k + 1]
        if top_of and all(abs(f[k] - g) * span > 1.0 for g in found):
            found.append(float(f[k]))
    return found


def avoid_mask(f: Array, avoid: Array, reach: float) -> Array:
    """True where f is within `reach` of a member of `avoid` (ascending)."""
    if len(avoid) == 0:
        return np.zeros(len(f), dtype=bool)
    near = np.clip(np.searchsorted(avoid, f), 1, len(avoid) - 1) if len(avoid) > 1 else np.zeros(len(f), int)
    gap = np.abs(f - avoid[near])
    if len(avoid) > 1:
        gap = np.minimum(gap, np.abs(f - avoid[near - 1]))
    return np.asarray(gap < reach)


def _around(power: Array, half: int) -> Array:
    """Median power around every bin."""
    from scipy.ndimage import uniform_filter1d

    # a median of blocks, widened: a running median over many bins is slow
    count = len(power) // half + 1
    padded = np.pad(power, (0, count * half - len(power)), mode="edge").reshape(count, half)
    block = np.median(padded, axis=1)
    level = uniform_filter1d(block, 3, mode="nearest")
    return np.asarray(np.repeat(level, half)[: len(power)] / np.log(2.0))
