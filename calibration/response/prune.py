"""What every accepted effect is worth at the end: one whose absence the held-out rows do not notice goes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.slowoffset import slowness, with_slow_offset
from calibration.channels.view import View
from calibration.decide.heldout import compare
from calibration.decide.judge import Refusal, design, phases
from calibration.decide.scan import Contender
from calibration.decide.select import Selection, fitted
from calibration.decide.thresholds import STILL_MISSING
from calibration.names.structural_mode import MOST_DAMPED
from calibration.readers.run import Array
from calibration.statistics.regression import Fit, gls
from calibration.statistics.whitening import Mask

PASSIVE = ("inertia", "viscous", "coulomb")  # terms that cannot be negative
STICTION = 0.2  # a dip of friction near rest, likewise: less is how friction turns (development seed 1011)
SEARCHED = ("bearing_pass", "command_disturbance")  # lines found among hundreds
LINE = 0.04  # what such a line must add, likewise
WORTH = 0.01  # of the final held-out mean square, that leaving an effect out must add
# of the mean square that all effects take off, held-out: an effect of another name than the strongest's that
# is worth less may be what the strongest one's formula (one sine, one time constant) leaves of it. A sixth in
# amplitude; effects of ratio 1 beside 5 are worth 1/26 (development seed 1012, opened sample of 20261122)
REMAINDER = 0.03
# standard errors, and share of the held-out mean square, that names take away where the position is resolved
# when they are more than what the sensor's steps make of the rest: most of it (ASSUMPTION)
SURE_Z, CLEAR_SHARE = 4.0, 0.5
CLEAR_Z = 3.0  # standard errors of what goes below the floor (opened seed 20261211: 3.4)
# of the same, that the strongest effect takes alone: where it takes less, others are there for themselves
DOMINANT = 0.95


def prune(s: Selection) -> Selection:
    """Leave effects out, the least worth first, while the held-out error hardly rises."""
    p = s.problem
    if p.test.sum() < 20:
        return s
    while s.chosen:
        now = _held(s, [x.candidate for x in s.chosen])
        cost = []
        for k in range(len(s.chosen)):
            rise = _held(s, [x.candidate for j, x in enumerate(s.chosen) if j != k]) / now - 1.0
            name = s.chosen[k].candidate.name
            least = LINE if name in SEARCHED else STICTION if name == "stribeck_change" else WORTH
            cost.append(rise / least)
        k = int(np.argmin(cost))
        if cost[k] >= 1.0:
            break
        s = _without(s, k, "adds too little to what is left when it is left out")
    return s


def remainders(s: Selection) -> Selection:
    """Leave out effects of another name than the strongest's that are worth a few per cent of what all of
    them take off: an imperfect model of the strongest effect leaves as much."""
    while len(s.chosen) > 1:
        strongest = dominant(s)
        if not strongest:
            break
        chosen = [x.candidate for x in s.chosen]
        nothing, now = _held(s, []), _held(s, chosen)
        rise = {
            k: _held(s, [x for j, x in enumerate(chosen) if j != k]) - now
            for k, c in enumerate(chosen)
            if c.name != strongest
        }
        k = min(rise, key=lambda j: rise[j], default=-1)
        if k < 0 or rise[k] >= REMAINDER * (nothing - now):
            break
        part = 100 * max(rise[k], 0.0) / (nothing - now)
        s = _without(s, k, f"worth {part:.1f} % of what is found: a remainder of {strongest} as well")
    return s


def dominant(s: Selection) -> str:
    """The name whose effects alone take off nearly all that all of them do, or empty."""
    if s.problem.test.sum() < 20 or not s.chosen:
        return ""
    chosen = [x.candidate for x in s.chosen]
    nothing, now = _held(s, []), _held(s, chosen)
    alone = {n: _held(s, [c for c in chosen if c.name == n]) for n in {c.name for c in chosen}}
    name = min(alone, key=lambda n: alone[n])
    return name if now < nothing and nothing - alone[name] >= DOMINANT * (nothing - now) else ""


def displaced(s: Selection, smooth: Candidate) -> Selection:
    """Leave out a name over the domain of a smooth function that does its work: one that is worth less than
    REMAINDER beside the function and leaves more than STILL_MISSING times the error that it alone does."""
    if s.problem.test.sum() < 20:
        return s
    for k, x in enumerate(s.chosen):
        if x.candidate.domain != smooth.domain:
            continue
        if smooth.domain == "axis_angle" and x.candidate.name != "position_friction":
            continue  # knots follow weights and lines; friction of one harmonic is a guess at what knots show
        chosen = [y.candidate for y in s.chosen]
        others = [c for j, c in enumerate(chosen) if j != k]
        trials: tuple[list[Candidate], ...] = ([], chosen, [*others, smooth], [*chosen, smooth])
        nothing, named, alone, both = (_held(s, c) for c in trials)
        if alone - both < REMAINDER * (nothing - both) and named > STILL_MISSING**2 * alone:
            return _without(s, k, f"a smooth function of {smooth.domain} leaves a fraction of what it leaves")
    return s


def sound(s: Selection) -> Selection:
    """Names beside which a mass or friction that was positive turns negative are not believed; and none is
    when all together make the held-out error worse."""
    while s.chosen:
        bad = _negative(s)
        if bad is None:
            break
        trials = [
            _without(s, k, f"beside it {bad} comes out negative, which feeds energy")
            for k in range(len(s.chosen))
        ]
        good = [x for x in trials if _negative(x) is None]
        s = min(good or trials, key=lambda x: x.held.after)
    while s.chosen and s.held.after > s.held.before:
        s = min(
            (_without(s, k, "the held-out error grows with what was found") for k in range(len(s.chosen))),
            key=lambda x: x.held.after,
        )
    return s


def more_than_an_offset(s: Selection, view: View) -> Selection:
    """Leave out what an offset that wanders in its place, without any of the drive's motion, predicts as well
    on held-out rows: along a few moves a walk follows the direction."""
    if not view.dynamic or s.problem.test.sum() < 20:
        return s
    wandering = with_slow_offset(s.problem, view, 2 * view.slow_offset or slowness(view))
    for k in reversed(range(len(s.chosen))):
        others = [x.candidate for j, x in enumerate(s.chosen) if j != k]
        if _held(replace(s, problem=wandering), others) <= _held(s, [x.candidate for x in s.chosen]):
            s = _without(s, k, "an offset that wanders slowly leaves as little")
    return s


def above(s: Selection) -> Selection:
    """Names are for what is above the floor: where the declared model alone is at it, what sensors and loop
    leave in the columns has many shapes."""
    while s.chosen and not is_above(s):
        s = _without(s, 0, "the declared model is at the floor without it")
    return s


def is_above(s: Selection) -> bool:
    """Whether the declared model leaves more than the floor, of all held-out rows or of those that coarse
    steps of the position do not spoil; or most of what it leaves goes with the names: then the floor is what
    a coarse sensor may hide, and did not."""
    most = s.held.share > CLEAR_SHARE and s.held.z > CLEAR_Z
    return s.held.before > s.problem.floor or most or _clear_of_steps(s)


def _clear_of_steps(s: Selection) -> bool:
    """Whether the names explain what is above the floor on the rows that coarse steps of the position do not
    spoil: a floor that reversals alone have raised says nothing of the rest of the motion."""
    p = s.problem
    if p.resolved is None:
        return False
    rows, floor = p.resolved
    part = replace(p, valid=rows)
    chosen = [x.candidate for x in s.chosen]
    x, _ = _fit(s, chosen)
    held = compare(part, p.base, s.before.beta, x, s.after.beta, s.after.whitener, ((), phases(p, chosen)))
    return held.before > floor and held.z > SURE_Z and held.share > CLEAR_SHARE


def within_bounds(s: Selection, resolved: float) -> Selection:
    """Leave out what ended where its shape means nothing: a loop narrower than the sensor's steps, a mode
    that is no resonance. `resolved`: travel, position units."""
    narrow = (-np.inf, resolved, "narrower than the sensor's steps show")
    bounds = (
        ("presliding", "breakaway_travel", *narrow),
        ("presliding", "bristle_travel", *narrow),
        ("play", "gap", *narrow),
        ("structural_mode", "damping", MOST_DAMPED, np.inf, "damped too much for a resonance"),
    )
    for name, key, low, high, why in bounds:
        at = [k for k, x in enumerate(s.chosen) if x.candidate.name == name]
        for k in reversed(at):
            if low <= s.chosen[k].candidate.fixed.get(key, (np.nan, ""))[0] <= high:
                s = _without(s, k, why)
    return s


def _negative(s: Selection) -> str | None:
    """A passive term that was positive before anything was named and is negative now."""
    for k, (name, _) in enumerate(s.problem.base_labels):
        if name in PASSIVE and s.before.beta[k] > 0 > s.after.beta[k]:
            return name
        if name == "coulomb" and s.after.beta[k] > 0:
            wave = max((float(np.hypot(*b)) for c, b in fitted(s) if _one_wave_of_friction(c)), default=0.0)
            error = float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
            if wave > s.after.beta[k] + SURE_Z * error:
                return "friction at some places"
    return None


def _one_wave_of_friction(c: Candidate) -> bool:
    return c.name == "position_friction" and c.width == 2


def _fit(s: Selection, chosen: list[Candidate]) -> tuple[Array, Fit]:
    p = s.problem
    x = design(p, chosen)
    return x, gls(p.y, x, p.train, p.ar_order, p.block)


def _held(s: Selection, chosen: list[Candidate]) -> float:
    """Mean square on the held-out rows."""
    x, fit = _fit(s, chosen)
    after = compare(s.problem, x, fit.beta, x, fit.beta, fit.whitener, (phases(s.problem, chosen),) * 2).after
    return after**2


def _without(s: Selection, k: int, why: str) -> Selection:
    gone = s.chosen[k].candidate
    keep = [j for j in range(len(s.chosen)) if j != k]
    again = _refitted(s, [s.chosen[j] for j in keep])
    return replace(
        again,
        classes=[s.classes[j] for j in keep],
        steps=[s.steps[j] for j in keep],
        refused=[*s.refused, Refusal(gone.say(), why)],
    )


def _refitted(s: Selection, chosen: list[Contender]) -> Selection:
    candidates = [x.candidate for x in chosen]
    x, fit = _fit(s, candidates)
    p = s.problem
    held = compare(p, p.base, s.before.beta, x, fit.beta, fit.whitener, ((), phases(p, candidates)))
    return replace(s, chosen=chosen, after=fit, held=held)


def beside(s: Selection, more: Selection) -> Selection:
    """The effects of `s` and those of `more` fitted together."""
    both = _refitted(s, [*s.chosen, *more.chosen])
    return replace(both, classes=[*s.classes, *more.classes], steps=[*s.steps, *more.steps])


def signed(s: Selection) -> Selection:
    """Every size keeps its sign in the fit of all of them: a part of an effect that does not is left out of
    it, and an effect without any other part goes."""
    for _ in range(sum(x.candidate.width for x in s.chosen)):
        sizes = fitted(s)
        bad = next((k for k, (c, beta) in enumerate(sizes) if not c.allowed(beta)), None)
        if bad is None:
            break
        c, beta = sizes[bad]
        good = beta * c.sign > 0
        if c.sign and good.any() and len(c.labels) == c.width:
            part = replace(s.chosen[bad], candidate=_part(c, good))
            s = _refitted(s, [part if j == bad else x for j, x in enumerate(s.chosen)])
        else:
            s = _without(s, bad, "beside the others its size comes out with a sign that physics excludes")
    return s


def _part(c: Candidate, good: Mask) -> Candidate:
    """The candidate with some of its columns."""
    whole = c.shape

    def shape(p: Array) -> Array:
        assert whole is not None
        return whole(p)[:, good]

    labels = tuple(x for x, g in zip(c.labels, good, strict=True) if g)
    return replace(c, columns=c.columns[:, good], labels=labels, shape=shape if whole is not None else None)
