"""Rules of signs: no part of a drive feeds energy, and a size keeps the sign that physics gives it."""

from dataclasses import replace

import numpy as np

from calibration.arrays import Mask
from calibration.balances.candidate import Candidate
from calibration.balances.problem import Estimate
from calibration.decide.selection import Selection
from calibration.names import NAMES
from calibration.names.coulomb_change import NAME as COULOMB_CHANGE
from calibration.names.friction_asymmetry import COULOMB
from calibration.statistics.thresholds import SURE_Z

#: declared terms that are positive in every drive: a fit with a negative one feeds energy
POSITIVE = ("inertia", "viscous", "coulomb", "resistance", "torque_constant")


def feeds_energy(s: Selection) -> tuple[int, str] | None:
    """A name beside which a mass or friction that was positive turns negative: the one without which none
    does and the held-out error is least. None goes where all of them and a term of zero leave less."""
    bad = _turned(s)
    if not bad:
        return None
    trials = s.each_left_out
    good = [k for k, x in enumerate(trials) if not _turned(x)] or range(len(trials))
    k = min(good, key=lambda k: trials[k].left)
    base, labels = s.problem.base, [label for label, _ in s.problem.base_labels]
    if bad in labels:
        none = replace(s.problem, base=base * (np.arange(base.shape[1]) != labels.index(bad)))
        if Selection.of(none, s.chosen).left < trials[k].left:
            return None
    return k, f"beside it {bad} comes out negative, which feeds energy"


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
    more = sum(float(sizes.sum()) for c, sizes in s.fitted if c.name == COULOMB_CHANGE.name)
    level = own.value + s.problem.known.get("coulomb", 0.0) + more
    return max(level, 0.0) + SURE_Z * own.error
