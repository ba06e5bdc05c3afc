"""Forward selection of effects in one channel, with out-of-run acceptance and re-tested earlier picks."""

from dataclasses import dataclass, replace

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide import rules
from calibration.decide import thresholds as limits
from calibration.decide.accept import SHORT, equivalents, refuse, scores, too_small
from calibration.decide.drive import EXPECTED
from calibration.decide.energy import negative, signed
from calibration.decide.heldout import cross_validate
from calibration.decide.refine import Rest, polish, settled
from calibration.decide.scan import Contender, few, fit_with, look
from calibration.decide.selection import NO_SCORES, Refusal, Selection
from calibration.statistics.regression import under
from calibration.statistics.surrogate import Scores, basis, orthonormal_blocks, score, together
from calibration.statistics.thresholds import SURE_Z


def select(
    problem: Problem,
    candidates: list[Candidate],
    rng: np.random.Generator | None = None,
    most: int = limits.MOST_EFFECTS,
    margin: float = limits.MARGIN,
    around: bool = False,
    before: int = 0,
) -> Selection:
    """Pick effects one by one while each helps on held-out rows; then hold them against surrogates.

    around: search once more without each pick. One name may imitate two that no step of the search takes.
    before: candidates of the same balance that were tried before these.
    """
    s = _searched(problem, candidates, most, margin, before)
    for pick in s.candidates if around else ():
        other = _searched(problem, [c for c in candidates if c.key != pick.key], most, margin, before)
        if _explains_more(other, s, margin):
            why = f"{' and '.join(c.say() for c in other.candidates)} explain it better"
            s = replace(other, refused=[*other.refused, Refusal(pick.say(), why)])
    s.scores = gate(s, candidates, np.random.default_rng(0) if rng is None else rng)
    return rules.leave_out(s, rules.below_surrogates)


def _searched(
    problem: Problem, candidates: list[Candidate], most: int, margin: float, before: int
) -> Selection:
    search = _Search(Selection.of(problem), candidates, margin, before)
    search.expect()
    search.pick(most)
    search.revise()
    return search.picks


def _explains_more(one: Selection, other: Selection, margin: float) -> bool:
    """On training rows that neither was fitted to, in every fold, by more than luck."""
    if not one.chosen:
        return False
    inside = cross_validate(one.problem, other.columns, one.columns, one.after.whitener)
    return inside.everywhere and inside.z > limits.LUCK_Z and inside.share > margin


def gate(s: Selection, candidates: list[Candidate], rng: np.random.Generator) -> Scores:
    """All candidates' scores on the declared terms' residual, thresholds from what the selection leaves."""
    if not candidates:
        return NO_SCORES
    p, w = s.problem, s.after.whitener
    e, noise, base = (w.whiten(x, p.train) for x in (s.before.residual, s.after.residual, p.base))
    own = basis(base)
    signs = rng.choice([-1.0, 1.0], size=(limits.DRAWS, len(range(0, len(e), p.block))))
    parts = []
    for some in few(candidates):  # all at once would be the largest array of the whole analysis
        q, widths = orthonormal_blocks([w.whiten(c.columns, p.train) for c in some], own)
        parts.append(score(e, noise, q, widths, p.block, signs))
    return together(parts, limits.GATE_LEVEL)


@dataclass
class _Search:
    """The effects picked so far."""

    picks: Selection
    candidates: list[Candidate]
    margin: float
    before: int

    def expect(self) -> None:
        """Accept what is expected by itself, before anything is searched for."""
        for c in self._testable([c for name in EXPECTED for c in self.candidates if c.name == name]):
            found = self.accepted(self.picks, [c], tries=1, further=False)
            more = self.picks.keep([*self.picks.chosen, *found])
            # along one speed either friction is the other, and both are large
            if not (bad := negative(more, SURE_Z)) or bad == negative(self.picks, SURE_Z):
                self.picks = more

    def _testable(self, some: list[Candidate]) -> list[Candidate]:
        """Those that the log has rows enough for."""
        p = self.picks.problem
        return [c for c in some if p.train.sum() >= limits.ROWS_PER_COLUMN * (p.base.shape[1] + c.width)]

    def pick(self, most: int) -> None:
        """Accept effects, strongest first, until none is acceptable or `most` are there."""
        taken = {c.key for c in self.picks.candidates}
        p, left = self.picks.problem, [c for c in self.candidates if c.key not in taken]
        if left and p.ar_order and p.blocks < limits.FEWEST_BLOCKS:  # they make the noise's filter, too
            seconds = limits.FEWEST_BLOCKS * p.block * p.period_s
            why = f"{SHORT}: coloured noise needs {limits.FEWEST_BLOCKS} independent blocks ({seconds:.0f} s)"
            self.picks.refused.append(Refusal("every effect that no declared stage has", why))
            left = [c for c in left if c.stage]
        left = self._testable(left)
        # where the log has too few rows for any, its power is told as if all had been looked at
        self.picks = replace(self.picks, looked_at=self.before + (len(left) or len(self.candidates)))
        while len(self.picks.chosen) < most and left:
            found = self.accepted(self.picks, left, limits.TRIED)[: most - len(self.picks.chosen)]
            if not found:
                break
            self.picks = rules.leave_out(self.picks.keep([*self.picks.chosen, *found]), rules.superfluous)
            taken = {x.candidate.key for x in found}
            left = [c for c in left if c.key not in taken]

    def revise(self) -> None:
        """Look at every pick again beside the others; drop what needs no name or has a size that none has."""
        replaced = False
        for k in range(len(self.picks.chosen)):
            first, *later = self.picks.candidates[k:]
            if first.name in EXPECTED:
                continue
            shares = (_shared(self.picks.problem, first, c) for c in later)
            if replaced or any(share > limits.APART for share in shares):
                replaced |= self._look_again(k)
        self.picks = rules.leave_out(self.picks, rules.needless(self.margin), rules.lesser_of_one_order)
        for k in range(len(self.picks.chosen)):
            self.picks = _polished(self.picks, k)
        self.picks = signed(self.picks)

    def _look_again(self, k: int) -> bool:
        """What was picked while the others were missing may be another's name; whether it is."""
        others = self.picks.without(k)
        taken = {c.key for c in others.candidates}
        left = [c for c in self.candidates if c.key not in taken]
        found, *_ = [*self.accepted(others, left, limits.TRIED_AGAIN, further=False), None]
        if found is None:
            return False
        was, now = self.picks.candidates[k], found.candidate
        if now.key != was.key:
            self.picks.refused.append(Refusal(was.say(), f"{now.say()} explains it better"))
        self.picks = self.picks.put(k, found)
        return now.key != was.key

    def accepted(
        self, others: Selection, candidates: list[Candidate], tries: int, further: bool = True
    ) -> list[Contender]:
        """The first of the best `tries` that nothing speaks against; no `further` one replaces a pick.

        A line comes with the lines next to it in rank that it has nothing in common with.
        """
        p, base, out = others.problem, others.columns, list[Contender]()
        contenders = look(p, base, others.after, candidates)
        for one in contenders[:tries]:
            if out and not _apart(p, one.candidate, out):
                break
            contender = replace(one, candidate=settled(p, base, one.candidate, one.fit))
            inside, held = scores(others, contender)
            tried = self.picks.looked_at
            why = refuse(contender, inside, held, self.margin, tried) or too_small(others, contender, further)
            if not why:
                rivals = [*contender.confounded, *equivalents(others, contenders, contender)]
                out.append(replace(contender, held=held, confounded=rivals))
                if not further:
                    break
            elif further and not out:
                self.picks.refused.append(Refusal(contender.candidate.say(), why))
        return out


def _apart(p: Problem, c: Candidate, taken: list[Contender]) -> bool:
    """Whether all are lines, and `c` has nothing in common with those that are taken."""
    others = [x.candidate for x in taken]
    lines = all(x.kind == "line" for x in [c, *others])
    return lines and max(_shared(p, c, x) for x in others) <= limits.APART


def _shared(p: Problem, one: Candidate, other: Candidate) -> float:
    """Largest share of mean square that two candidates can take from each other."""
    centred = (c.columns[p.train] - c.columns[p.train].mean(axis=0) for c in (one, other))
    a, b = (np.linalg.qr(x)[0] for x in centred)
    return float(np.linalg.norm(a.T @ b, 2)) ** 2


def _polished(s: Selection, k: int) -> Selection:
    """Pick `k`'s nonlinear parameters moved together, beside the others."""
    pick, p = s.chosen[k], s.problem
    if len(pick.candidate.steps) < 2:
        return s
    others = s.without(k)
    base = others.columns
    rest = Rest(p.train, base, others.after.residual, pick.fit.whitener)
    better = polish(rest, pick.candidate)
    found = fit_with(p, base, better)
    if found is None:
        return s
    now, was = (
        under(p.y, np.hstack([base, c.columns]), p.train, found.fit.whitener)
        for c in (found.candidate, pick.candidate)
    )
    kept = found if now > was else pick
    return s.put(k, replace(kept, candidate=settled(p, base, kept.candidate, kept.fit)))
