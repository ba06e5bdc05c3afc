"""Rules by which a chosen effect is left out of any selection, and the one loop that applies them.

A rule gives the place of an effect that must go, and why; None when all may stay. The selection is fitted
anew, the rule asked again.
"""

from collections.abc import Callable

from calibration.balances.candidate import Candidate
from calibration.decide import thresholds as limits
from calibration.decide.accept import refuse, scores
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from calibration.statistics.regression import under

Rule = Callable[[Selection], tuple[int, str] | None]


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


def superfluous(s: Selection) -> tuple[int, str] | None:
    """The first pick that later ones made superfluous. A steady one may be in the noise's filter, which is
    made of what it leaves. Then it takes much of the held-out square all the same."""
    for k, c in enumerate(s.candidates[:-1]):
        others = s.without(k)
        again = fit_with(s.problem, others.columns, c)
        if (again is None or again.bayes <= 0) and not s.left < (1 - limits.PLAINLY) * others.left:
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
