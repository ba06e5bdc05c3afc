"""Rules of a balance of a single drive (look/search.py). Without held-out rows nothing is compared: NaN."""

from dataclasses import replace
from itertools import combinations

import numpy as np

from calibration.decide import thresholds as limits
from calibration.decide.heldout import HeldOut
from calibration.decide.parameters import parameters_of
from calibration.decide.rules import Rule, each
from calibration.decide.scan import Contender
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.names import NAMES
from calibration.names.coulomb_change import NAME as COULOMB_CHANGE
from calibration.names.name import OWN_ERRORS
from calibration.names.structural_mode import rings
from calibration.names.viscous_change import NAME as VISCOUS_CHANGE
from calibration.statistics.tails import rms
from calibration.statistics.thresholds import SURE_Z

#: friction that every drive has: where nobody stated it, it comes before what might stand in for it
EXPECTED = (COULOMB_CHANGE.name, VISCOUS_CHANGE.name)
#: domains that a column of the log tells which is neither the motion nor the clock
OTHER_COLUMNS = ("current", "temperature")


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
    taken = s.without(k).left - s.left
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
    gone = min(pair, key=lambda k: float(np.nan_to_num(s.without(k).left)))
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
    unexplained = max(s.left - s.problem.floor**2, 0.0) if s.problem.floor else 0.0
    least = (NAMES[c.name].worth * s.left + limits.OF_THE_UNEXPLAINED * unexplained for c in s.candidates)
    cost = [(x.left - s.left) / w for x, w in zip(s.each_left_out, least, strict=True)]
    k = int(np.argmin(cost))
    return (k, "adds too little to what is left when it is left out") if cost[k] < 1.0 else None


def remainder(s: Selection) -> tuple[int, str] | None:
    """An effect worth a few per cent of all: an imperfect model of the strongest one leaves as much.

    Not one that takes much of what is left above the floor without it, and follows another column of the log.
    Nor a line that does, where the strongest one is a function of the time.
    """
    strongest = dominant(s)
    if not strongest:
        return None
    taken = s.held.taken
    slow = any(c.domain == "time" for c in s.candidates if c.name == strongest)
    apart = [c.domain in OTHER_COLUMNS or (slow and c.kind == "line") for c in s.candidates]
    without = [x.left for x in s.each_left_out]
    plain = np.array(without) > max(s.problem.floor**2, s.left / (1 - limits.PLAINLY))
    told = np.array([c.name == strongest for c in s.candidates]) | (apart & plain)
    worth = np.where(told, np.inf, np.array(without) - s.left)
    k = int(np.argmin(worth))
    part = f"{100 * max(worth[k], 0.0) / taken:.1f} %"
    why = f"worth {part} of what is found: a remainder of {strongest} as well"
    return (k, why) if worth[k] < limits.REMAINDER * taken else None


def dominant(s: Selection) -> str:
    """The name, expected friction first, whose effects alone take off nearly all that all do; or empty."""
    names = {c.name for c in s.candidates}
    alone = {n: s.keep([x for x in s.chosen if x.candidate.name == n]).left for n in names}
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
        alone, both = s.put(k, smooth).left, s.keep([*s.chosen, smooth]).left
        little = alone - both < limits.REMAINDER * (s.held.before**2 - both)
        of_all = little and s.left > limits.STILL_MISSING**2 * alone
        return f"a smooth function of {domain} leaves a fraction of what it leaves" if of_all else ""

    return each(why)


def harmful(s: Selection) -> tuple[int, str] | None:
    """The name without which the held-out error is least, where it grows with all of them."""
    if not s.held.after > s.held.before:
        return None
    best = int(np.argmin([x.left for x in s.each_left_out]))
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
    others = [_off_the_steps(x) for x in s.each_left_out]
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
