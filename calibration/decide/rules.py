"""Rules by which a chosen effect is left out again, and the one loop that applies them.

A rule gives the place of an effect that must go, and why; None when all may stay. The selection is fitted
anew, the rule asked again.
"""

from collections.abc import Callable
from dataclasses import replace
from itertools import combinations

import numpy as np

from calibration.arrays import Mask
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Estimate
from calibration.decide import thresholds as limits
from calibration.decide.accept import refuse, scores
from calibration.decide.heldout import HeldOut
from calibration.decide.parameters import parameters_of
from calibration.decide.scan import Contender, fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.names import NAMES
from calibration.names.friction_asymmetry import COULOMB
from calibration.names.name import OWN_ERRORS
from calibration.names.structural_mode import rings
from calibration.statistics.regression import under
from calibration.statistics.tails import rms
from calibration.statistics.thresholds import SURE_Z

Rule = Callable[[Selection], tuple[int, str] | None]

#: declared terms that are positive in every drive: a fit with a negative one feeds energy
POSITIVE = ("inertia", "viscous", "coulomb", "resistance", "torque_constant")
CHANGE = "coulomb_change"
#: friction that every drive has: where nobody stated it, it comes before what might stand in for it
EXPECTED = (CHANGE, "viscous_change")
#: domains that a column of the log tells which is neither the motion nor the clock
OTHER_COLUMNS = ("current", "temperature")


def leave_out(s: Selection, *rules: Rule) -> Selection:
    """The selection without what the rules, one after another, speak against."""
    for rule in rules:
        while s.chosen and (found := rule(s)) is not None:
            s = s.without(*found)
    return s


def each(why: Callable[[Selection, int], str]) -> Rule:
    """The rule that asks, last effect first, why it must go; an empty text lets it stay."""

    def rule(s: Selection) -> tuple[int, str] | None:
        asked = ((k, why(s, k)) for k in reversed(range(len(s.chosen))))
        return next(((k, text) for k, text in asked if text), None)

    return rule


# --- of every selection (decide/select.py)


def superfluous(s: Selection) -> tuple[int, str] | None:
    """The first pick that later ones made superfluous. A steady one may be in the noise's filter, which is
    made of what it leaves. Then it takes much of the held-out square all the same."""
    for k, c in enumerate(s.candidates[:-1]):
        others = s.without(k)
        again = fit_with(s.problem, others.columns, c)
        if (again is None or again.bayes <= 0) and not _left(s) < (1 - limits.PLAINLY) * _left(others):
            return k, "superfluous once the others are in"
    return None


def needless(margin: float) -> Rule:
    """An unnamed function that would not be accepted beside the others: it stood for what has a name now."""

    def why(s: Selection, k: int) -> str:
        if s.candidates[k].name != UNKNOWN or len(s.chosen) < 2:
            return ""
        others = s.without(k)
        again = fit_with(s.problem, others.columns, s.candidates[k])
        text = (
            "cannot be determined"
            if again is None
            else refuse(again, *scores(others, again), margin, s.looked_at)
        )
        return f"beside the others: {text}" if text else ""

    return each(why)


def lesser_of_one_order(s: Selection) -> tuple[int, str] | None:
    """An effect that gains less than MORE of what another one of its order gains.

    A line's columns know angle, speed and current only so well. What that leaves has its order, and another
    name of that order takes it: ripple beside cogging, a motor's harmonic beside a tooth.
    """
    p, have = s.problem, s.candidates

    def gain(*gone: int) -> float:
        """Log likelihood without some, through the filter of the fit of all."""
        kept = [c for k, c in enumerate(have) if k not in gone]
        return under(p.y, p.design(kept), p.train, s.after.whitener)

    for pair in [(i, j) for i in range(len(have)) for j in range(i) if _same_order(have[i], have[j])]:
        lesser, greater = sorted(pair, key=gain, reverse=True)
        kept = gain(lesser)
        if gain() - kept < limits.MORE * (kept - gain(*pair)):
            return lesser, f"its order is that of {have[greater].say()}, whose shape leaves as much"
    return None


def _same_order(one: Candidate, other: Candidate) -> bool:
    if one.order is None or other.order is None or one.name == other.name:
        return False
    return abs(one.order - other.order) < limits.SAME_ORDER_SHARE * abs(one.order)


@each
def below_surrogates(s: Selection, k: int) -> str:
    """An effect with less evidence than the surrogates of the residual have."""
    evidence, least = s.chosen[k].evidence, s.scores.threshold
    return f"below the surrogate threshold ({evidence:.1f} < {least:.1f})" if evidence < least else ""


# --- of a balance of a single drive (look/search.py). Without held-out rows nothing is compared: NaN


def within_bounds(resolved: float) -> Rule:
    """Shapes that mean nothing: a loop within the sensor's steps (`resolved`, of position), no resonance."""
    loops = [parameter for name in NAMES.values() for parameter in name.loop]

    def why(s: Selection, k: int) -> str:
        at = {n: value for n, (value, _) in s.candidates[k].fixed.items()}
        if larger_than_the_response(s, k):
            return "larger than the response's own range: it cancels against something else"
        if any(at[n] <= resolved for n in loops if n in at):
            return "narrower than the sensor's steps show"
        told = parameters_of(s, k)
        if "width" in told and (told["width"].low or 0.0) < 0.0:
            return "as wide as nothing, by its interval"
        if "order" in told and (told["order"].low or 0.0) < 0.0:
            return "of any order, by its interval"
        return "no damping of a resonance" if "damping" in told and not rings(told["damping"]) else ""

    return each(why)


@each
def within_own_errors(s: Selection, k: int) -> str:
    """A function without a name of a force that takes no more than the declared terms' own errors leave.

    Only where nothing has a name, and much more than the floor is left: no such error goes down to it.
    """
    p, rows = s.problem, s.problem.train
    if p.channel != "T" or any(c.name != UNKNOWN for c in s.candidates):
        return ""
    taken = _left(s.without(k)) - _left(s)
    small = taken < (OWN_ERRORS * np.std(p.y[rows] - s.before.residual[rows])) ** 2
    much = 0 < limits.STILL_MISSING * p.floor < s.held.after
    return f"less than {100 * OWN_ERRORS:.0f} % of what the declared terms carry" if small and much else ""


def cancelling(s: Selection) -> tuple[int, int] | None:
    """Two effects of which one takes most of the other away: neither is as large as it is said to be."""
    each_effect = [s.effect(k)[s.problem.train] for k in range(len(s.chosen))]
    for j, k in combinations(range(len(s.chosen)), 2):
        one, other = each_effect[j], each_effect[k]
        if np.std(one + other) < limits.CANCELS * min(float(np.std(one)), float(np.std(other))):
            return j, k
    return None


def cancelled(s: Selection) -> tuple[int, str] | None:
    """Of two effects that cancel each other the one whose absence leaves less on held-out rows."""
    if (pair := cancelling(s)) is None:
        return None
    gone = min(pair, key=lambda k: float(np.nan_to_num(_left(s.without(k)))))
    return gone, f"cancels against {s.candidates[sum(pair) - gone].say()}"


def larger_than_the_response(s: Selection, k: int) -> bool:
    """Whether an effect, a harmonic of a line, or a smooth function goes further than the response does.

    Where it also leaves more than there was, it cancels against another. A loop takes friction's place, which
    it cancels. Two masses pull against each other at the resonance: there the second one is a part of the
    inertia, or is none.
    """
    c, rows, y = s.candidates[k], s.problem.valid, s.problem.y[s.problem.valid]
    if c.name != UNKNOWN and NAMES[c.name].loop:
        return False
    whole = s.problem.named(s.after).get("inertia")
    if "damping" in c.fixed and whole is not None:
        return bool(s.sizes(k)[0] > whole.value)
    parts = (c.columns[rows] * s.sizes(k)).reshape(int(rows.sum()), -1, 2 if c.kind == "line" else c.width)
    waves = parts.sum(axis=2)
    widest = waves[:, np.argmax(np.ptp(waves, axis=0))]
    return bool(np.ptp(widest) > np.ptp(y) and np.std(y - widest) > np.std(y))


def worth_little(s: Selection) -> tuple[int, str] | None:
    """The effect whose absence the held-out rows notice least, where that is hardly at all.

    Or it is little beside what nothing explains above a floor: names that are not there take some of that.
    """
    unexplained = max(_left(s) - s.problem.floor**2, 0.0) if s.problem.floor else 0.0
    least = (NAMES[c.name].worth * _left(s) + limits.OF_THE_UNEXPLAINED * unexplained for c in s.candidates)
    cost = [(_left(x) - _left(s)) / w for x, w in zip(_each_left_out(s), least, strict=True)]
    k = int(np.argmin(cost))
    return (k, "adds too little to what is left when it is left out") if cost[k] < 1.0 else None


def remainder(s: Selection) -> tuple[int, str] | None:
    """An effect worth a few per cent of all: an imperfect model of the strongest one leaves as much.

    Not one that follows another column of the log, and takes much of what is left above the floor without it.
    """
    strongest = dominant(s)
    if not strongest:
        return None
    taken = s.held.taken
    each_worth = [_left(x) - _left(s) for x in _each_left_out(s)]
    least = s.problem.floor**2
    told = [
        c.name == strongest
        or (c.domain in OTHER_COLUMNS and x + _left(s) > max(least, _left(s) / (1 - limits.PLAINLY)))
        for c, x in zip(s.candidates, each_worth, strict=True)
    ]
    worth = np.where(told, np.inf, each_worth)
    k = int(np.argmin(worth))
    part = f"{100 * max(worth[k], 0.0) / taken:.1f} %"
    why = f"worth {part} of what is found: a remainder of {strongest} as well"
    return (k, why) if worth[k] < limits.REMAINDER * taken else None


def dominant(s: Selection) -> str:
    """The name, expected friction first, whose effects alone take off nearly all that all do; or empty."""
    names = {c.name for c in s.candidates}
    alone = {n: _left(s.keep([x for x in s.chosen if x.candidate.name == n])) for n in names}
    nearly = [n for n in alone if s.held.before**2 - alone[n] >= limits.DOMINANT * s.held.taken > 0]
    return min(nearly, key=lambda n: (n not in EXPECTED, alone[n]), default="")


def displaced(smooth: Contender) -> Rule:
    """A name that is worth little beside a smooth function of its domain, and leaves much more than it."""
    domain = smooth.candidate.domain

    def why(s: Selection, k: int) -> str:
        c = s.candidates[k]
        # knots follow weights and lines; friction of one harmonic is a guess at what knots show
        if c.domain != domain or (domain == "axis_angle" and not NAMES[c.name].waves_of_friction):
            return ""
        alone, both = _left(s.put(k, smooth)), _left(s.keep([*s.chosen, smooth]))
        little = alone - both < limits.REMAINDER * (s.held.before**2 - both)
        of_all = little and _left(s) > limits.STILL_MISSING**2 * alone
        return f"a smooth function of {domain} leaves a fraction of what it leaves" if of_all else ""

    return each(why)


def feeds_energy(s: Selection) -> tuple[int, str] | None:
    """A name beside which a mass or friction that was positive turns negative: the one without which none
    does and the held-out error is least. None goes where all of them and a term of zero leave less."""
    bad = _turned(s)
    if not bad:
        return None
    trials = _each_left_out(s)
    good = [k for k, x in enumerate(trials) if not _turned(x)] or range(len(trials))
    k = min(good, key=lambda k: _left(trials[k]))
    base, labels = s.problem.base, [label for label, _ in s.problem.base_labels]
    if bad in labels:
        none = replace(s.problem, base=base * (np.arange(base.shape[1]) != labels.index(bad)))
        if _left(Selection.of(none, s.chosen)) < _left(trials[k]):
            return None
    return k, f"beside it {bad} comes out negative, which feeds energy"


def harmful(s: Selection) -> tuple[int, str] | None:
    """The name without which the held-out error is least, where it grows with all of them."""
    if not s.held.after > s.held.before:
        return None
    best = int(np.argmin([_left(x) for x in _each_left_out(s)]))
    return best, "the held-out error grows with what was found"


def below_floor(s: Selection) -> tuple[int, str] | None:
    """Names are for what is above the floor. Unless most goes with them: then the floor is what a coarse
    sensor may hide, and did not. Or they are for fitted rows, as what is far above it there."""
    p = s.problem
    fitted = rms(s.before.residual[p.train]) > limits.STILL_MISSING * p.floor > 0
    if s.held.before > p.floor or fitted or clear(s) or _clear_of_steps(s):
        return None
    return 0, "the declared model is at the floor without it"


def clear(s: Selection) -> bool:
    """Whether most of the held-out error goes with what was found, and not by luck."""
    return s.held.share > limits.CLEAR_SHARE and s.held.z > limits.CLEAR_Z


def of_the_steps(s: Selection) -> tuple[int, str] | None:
    """Names that hardly take anything off the rows which a sensor's coarse steps do not spoil."""
    held = _off_the_steps(s)
    if held is None or not held.share <= limits.NOISE_SHARE:
        return None
    others = [_off_the_steps(x) for x in _each_left_out(s)]
    k = int(np.argmin([np.inf if one is None else float(np.nan_to_num(one.after)) for one in others]))
    return k, "only rows that the position's steps spoil have it"


def _off_the_steps(s: Selection) -> HeldOut | None:
    """Held-out errors on rows that coarse steps do not spoil; None where no steps do, or too few are left."""
    if s.problem.resolved is None:
        return None
    p, rows = s.problem, s.problem.resolved[0]
    # of files in turn the fit stays that of all their rows
    clean = replace(p, valid=p.valid & rows) if p.turned is None else replace(p, turned=p.turned & rows)
    return s.held_on(clean) if clean.test.sum() >= limits.FEWEST_TOLD else None


def _clear_of_steps(s: Selection) -> bool:
    """Whether names explain the rows that coarse steps do not spoil: reversals alone raised the floor."""
    held = _off_the_steps(s)
    if held is None or s.problem.resolved is None:
        return False
    return held.before > s.problem.resolved[1] and held.z > SURE_Z and held.share > limits.CLEAR_SHARE


def _each_left_out(s: Selection) -> list[Selection]:
    return [s.without(k) for k in range(len(s.chosen))]


def _left(s: Selection) -> float:
    """Mean square on the held-out rows; NaN where they are too few."""
    return s.held.after**2


def signed(s: Selection) -> Selection:
    """Every size keeps its sign in the joint fit: parts that do not go, and effects without another part."""
    for _ in range(sum(c.width for c in s.candidates)):
        bad = next((k for k, (c, beta) in enumerate(s.fitted) if not c.allowed(beta)), None)
        if bad is None:
            break
        c, good = s.candidates[bad], s.sizes(bad) * s.candidates[bad].sign > 0
        if good.any() and len(c.labels) == c.width:
            s = s.put(bad, replace(s.chosen[bad], candidate=_part(c, good)))
        else:
            s = s.without(bad, "beside the others its size comes out with a sign that physics excludes")
    return s


def _part(c: Candidate, good: Mask) -> Candidate:
    """The candidate with some of its columns."""
    whole = c.shape
    labels = tuple(x for x, g in zip(c.labels, good, strict=True) if g)
    shape = None if whole is None else lambda p: whole(p)[:, good]
    return replace(c, columns=c.columns[:, good], labels=labels, shape=shape)


def negative(s: Selection, standard_errors: float = 0.0) -> str:
    """The first term that only a fit has negative, by more than some standard errors; or empty."""
    for name, x in s.problem.named(s.after).items():
        if name in POSITIVE and x.value < -standard_errors * x.error:
            return name
    return ""


def _turned(s: Selection) -> str:
    """Mass or friction that was positive without names and is negative now, or at some places; or empty.

    Or that is negative beyond its error, and was not.
    """
    was, now = s.problem.named(s.before), s.problem.named(s.after)
    for name, x in now.items():
        surely = x.value < -SURE_Z * x.error < 0 and was[name].value > -SURE_Z * was[name].error
        if name in POSITIVE and (was[name].value > 0 > x.value or surely):
            return name
    if not now.keys() & {"coulomb", "viscous"}:  # one way only friction is an offset
        return ""
    most = _friction(s)
    pairs = (b for c, b in s.fitted if NAMES[c.name].waves_of_friction and c.width == 2)
    if max((float(np.hypot(*b)) for b in pairs), default=0.0) > most:
        return "friction at some places"
    told = ((label, abs(b)) for c, sizes in s.fitted for label, b in zip(c.labels, sizes, strict=False))
    if any(label == (COULOMB, s.problem.unit) and b > most for label, b in told):
        return "friction one way"
    return ""


def _friction(s: Selection) -> float:
    """Friction at every speed, declared or found, with what its error may add, in the response's unit."""
    own = s.problem.named(s.after).get("coulomb", Estimate(0.0, 0.0))
    more = sum(float(sizes.sum()) for c, sizes in s.fitted if c.name == CHANGE)
    level = own.value + s.problem.known.get("coulomb", 0.0) + more
    return max(level, 0.0) + SURE_Z * own.error
