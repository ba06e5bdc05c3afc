"""Two names for one trace: which of them held-out rows have, and which comes first where they do not say.

Two lines that a log at one speed does not tell apart are one, whose size or rate changes along the log.
"""

from dataclasses import replace
from itertools import product

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate, sine_columns
from calibration.decide.drive import EXPECTED
from calibration.decide.heldout import compare
from calibration.decide.refine import Rest, refine
from calibration.decide.scan import Contender, fit_with
from calibration.decide.selection import Refusal, Selection
from calibration.decide.thresholds import DOMINANT, LUCK_Z
from calibration.finding import UNKNOWN
from calibration.names import NAMES, gravity_imbalance
from calibration.names.brake_drag import CHANGES
from calibration.names.lines import CLOCKED, on_clock
from calibration.names.scene import Scene
from calibration.statistics.regression import solve

# frequencies within a resolution cell, by which the clock's is found. ASSUMPTION: a tenth of a cell apart
TRIED = 21
# cycles by which two lines part within the travel, before it tells them apart (Rayleigh). definition
PARTED = 1.0


def told_by_the_clock(s: Selection, scene: Scene) -> Selection:
    """Lines over the place that the clock does not explain as well on held-out rows have no twin there."""
    for k, c in enumerate(s.candidates):
        if CLOCKED not in c.twins or c.order is None or not np.isfinite(s.held.after):
            continue
        other = _clocked(s, k, scene)
        if compare(s.problem, other.model, s.model, s.after.whitener).sure:
            alone = replace(c, twins=tuple(t for t in c.twins if t != CLOCKED))
            s = s.put(k, replace(s.chosen[k], candidate=alone))
    return s


def told_by_the_way(s: Selection, scene: Scene) -> Selection:
    """Friction that changes at some time turns over with the motion. Where held-out rows do not tell it from
    an offset that changes then, it has no name: `unknown` is its twin."""
    for k, c in enumerate(s.candidates):
        clock = next((name for name in c.fixed if name in scene.clocks), "")
        if c.name not in CHANGES or scene.pair is not None or not clock or not np.isfinite(s.held.after):
            continue
        step = scene.at((scene.clocks[clock] >= c.fixed[clock][0]).astype(float))[:, None]
        offset = s.put(k, replace(s.chosen[k], candidate=replace(c, columns=step)))
        if not compare(s.problem, offset.model, s.model, s.after.whitener).sure:
            s = s.put(k, replace(s.chosen[k], candidate=replace(c, twins=(*c.twins, UNKNOWN))))
    return s


def weight_first(s: Selection, scene: Scene) -> Selection:
    """A spring over less than a turn is a weight first, unless held-out rows refuse that beside its loop."""
    for k, c in enumerate(s.candidates):
        for weight in gravity_imbalance.columns(scene) if gravity_imbalance.NAME.name in c.twins else ():
            others = s.without(k)
            found = fit_with(s.problem, others.columns, replace(weight, twins=(c.name, *weight.twins)))
            if found is None:
                continue
            looped = replace(c, columns=np.hstack([weight.columns, c.columns[:, 1:]]))
            both = s.put(k, replace(s.chosen[k], candidate=looped))
            if compare(s.problem, both.model, s.model, s.after.whitener).z < LUCK_Z:
                held = compare(s.problem, others.model, s.put(k, found).model, s.after.whitener)
                s = s.put(k, replace(found, held=held))
    return s


def told_by_the_speed(s: Selection, scene: Scene) -> Selection:
    """Of Coulomb's and viscous friction alone either has the other as its twin, where that takes as much.

    As much is DOMINANT of it, which is what an imperfect model of the one leaves to the other.
    """
    found = [k for k, c in enumerate(s.candidates) if c.name in EXPECTED]
    if len(found) != 1:
        return s
    (k,), others = found, s.without(found[0])
    c, most = s.candidates[k], others.left - DOMINANT * (others.left - s.left)
    for other in [one for name in EXPECTED if name != c.name for one in NAMES[name].columns(scene)]:
        swapped = fit_with(s.problem, others.columns, other)
        if swapped is not None and s.put(k, swapped).left < most:
            s = s.put(k, replace(s.chosen[k], candidate=replace(c, twins=(*c.twins, other.name))))
    return s


def _clocked(s: Selection, k: int, scene: Scene) -> Selection:
    """The selection with pick `k`'s harmonics as multiples of one frequency, the best of its resolution cell.

    It is looked for twice, finer about the first. On rows that are held out a tenth of a cell is a third of a
    radian, by which the clock would lose.
    """
    c, v, p, best = s.candidates[k], scene.view, s.problem, 0.0
    t, files = v.t[v.rows], scene.problem.session
    waves = range(1, 2 if c.harmonic or c.stage is None else c.width // 2 + 1)
    hertz = [abs(_rate(scene, c) * h * scene.one_speed[0]) for h in waves]
    cell = 1.0 / (float(np.ptp(t)) * hertz[0])

    others = s.without(k).columns[p.train]

    def waves_at(shift: float) -> Array:
        return np.hstack([sine_columns(t * f * (1 + shift * cell), files) for f in hertz])

    def left(shift: float) -> float:
        x = np.hstack([others, waves_at(shift)[p.train]])
        return float(np.sum((p.y[p.train] - x @ solve(x, p.y[p.train])) ** 2))

    for half in (1.0, 2.0 / (TRIED - 1)):
        best = min(best + np.linspace(-half, half, TRIED), key=left)
    return s.put(k, replace(s.chosen[k], candidate=replace(c, columns=waves_at(best))))


def one_line(s: Selection, scene: Scene) -> Selection:
    """Of a line of no stage and one on the clock beside it the latter stays, unless held-out rows refuse it.

    A line that fades in is a line and one next to it. The second has a name of its own by accident alone.
    """
    for place, clock in product(range(len(s.chosen)), repeat=2):
        if not _beside(scene, s.candidates[place], s.candidates[clock]):
            continue
        why = f"the log does not tell its line from that of {s.candidates[clock].say()}"
        on_the_clock = [s.put(clock, c).without(place, why) for c in _either(s, scene, place, clock)]
        rather = s.without(clock)
        held = (compare(s.problem, c.model, rather.model, rather.after.whitener) for c in on_the_clock)
        if not all(one.sure for one in held):
            return one_line(min(on_the_clock, key=lambda c: c.fitted_square), scene)
        why = f"the log does not tell its line from that of {s.candidates[place].say()}"
        return one_line(s.without(clock, why), scene)
    return s


def beside_a_stage(s: Selection, scene: Scene) -> Selection:
    """A stage's line and one of no stage next to it are a single one of no stage, where that leaves less.

    A stage's line is picked before its neighbours, unless they gain clearly more. What it leaves then has a
    name by accident.
    """
    p = s.problem
    for pair in product(range(len(s.chosen)), repeat=2):
        one, other = (s.candidates[k] for k in pair)
        if not _next_to(scene, one, other):
            continue
        others = s.keep([x for k, x in enumerate(s.chosen) if k not in pair])
        rest = Rest(p.train, others.columns, others.after.residual, s.after.whitener)
        for c in one.neighbours:
            found = fit_with(p, others.columns, refine(rest, c))
            alone = s if found is None else others.keep([*others.chosen, found])
            if found is not None and alone.fitted_square < s.fitted_square:
                held = compare(p, others.model, alone.model, alone.after.whitener)
                alone.chosen = [*others.chosen, replace(found, held=held)]
                why = "a single line of no stage leaves less"
                alone.refused = [*s.refused, Refusal(f"{one.say()} and {other.say()}", why)]
                return beside_a_stage(alone, scene)
    return s


def _next_to(scene: Scene, one: Candidate, other: Candidate) -> bool:
    """Whether a stage's single line and one of no stage have a part of their main lobes in common."""
    if {one.kind, other.kind} != {"line"} or one.order is None or other.order is None:
        return False
    if one.stage is None or one.harmonic is None or other.stage is not None:
        return False
    return abs(_rate(scene, one) - _rate(scene, other)) * scene.span < 2 * PARTED


def _either(s: Selection, scene: Scene, place: int, clock: int) -> list[Contender]:
    """The line on the clock as it was found, and where the one over the place was."""
    x, hertz = s.chosen[clock], _rate(scene, s.candidates[place]) * abs(scene.one_speed[0])
    return [x, replace(x, candidate=x.candidate.moved(np.array([hertz])))]


def _beside(scene: Scene, place: Candidate, clock: Candidate) -> bool:
    """Whether a line of no stage and one on the clock part by less than a cycle, where the speed is one."""
    if (place.kind, clock.kind) != ("line", "line") or place.order is None or place.stage is not None:
        return False
    rate = _rate(scene, place)
    if clock.shape is None or clock.free != ["frequency"] or not on_clock(scene, rate):
        return False
    return abs(rate - float(clock.point[0]) / abs(scene.one_speed[0])) * scene.span < PARTED


def _rate(scene: Scene, place: Candidate) -> float:
    """Cycles per position unit of a line over the place, as refined."""
    return (place.at_order or 0.0) / scene.turn
