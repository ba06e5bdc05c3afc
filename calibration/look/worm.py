"""The periodic parts of a guided mount in its drive error: worms, transfer gears, periods of no part."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.guide import SLOWEST_S
from calibration.balances.mounts import SIDEREAL_DAY_S, Part
from calibration.balances.problem import Problem
from calibration.balances.thresholds import APART_TURNS, AS_QUICK
from calibration.decide.heldout import compare, cross_validate
from calibration.decide.parameters import finding_of
from calibration.decide.select import select
from calibration.decide.selection import Refusal, Selection
from calibration.decide.thresholds import LUCK_Z
from calibration.finding import UNKNOWN, Finding
from calibration.names.name import candidate
from calibration.statistics.regression import solve

ASSUMED = "the log names no mount that is known here: the wheel is the usual one that fits"
LEAST_IN_SECTION = 1.2  # fitted turns of a section for its own phase to mean anything. ASSUMPTION
# of the held-out mean square, that a part of the mount in the log must take away, and one of the usual
# wheels or any free period: on 30 worm-free logs with slow quasi-periodic wander (seeds 0 to 29 of
# tests/calibration/guidelogs.py) three of these took 9 to 27 % of the ends that were held out then, the worms
# of the measured logs 81 to 98 %
PART_GAIN = 0.15
FREE_GAIN = 0.35  # share likewise, of one of the usual wheels or any free period, on the same seeds
NEXT = 0.9  # of the slowest period looked for: a found one below it lets more be drift. ASSUMPTION
LEAST_TURNS = 2.0  # worm turns in a section below which a worm cannot be separated from drift. ASSUMPTION
IN_ALL = 3.0  # worm turns likewise, of all sections whose own phase shows: drifts differ. ASSUMPTION
HARMONICS = 8  # harmonics of a worm that are looked at. ASSUMPTION
KEPT = 0.002  # part of its rate, that a mount keeps at least: 0.03 arcsec/s. ASSUMPTION
NEAR = np.linspace(-0.5, 0.5, 21)  # turns in the longest section, by which a rate may be another. arithmetic


@dataclass(frozen=True, kw_only=True)
class Mount:
    """Periodic parts that a mount may have; `named`: the log or a rig file says which they are."""

    parts: list[Part]
    named: bool

    @property
    def periods_s(self) -> list[float]:
        """Of the parts, the shortest first."""
        return sorted(1.0 / part.rate for part in self.parts) or [SLOWEST_S]


def harmonics(problem: Problem, rate: float, waves: Sequence[int]) -> Array:
    """cos, sin of a turn's harmonics per section: the worm's phase is a nuisance of the section.

    A section with less than LEAST_IN_SECTION turns to fit has none: offset and drift would imitate them.
    """
    at, parts = problem.domains.get("clock", problem.t), []
    sections = np.zeros_like(problem.run) if "clock" in problem.domains else problem.run
    for k in np.unique(sections):
        m = sections == k
        seen = at[m & problem.train]
        if len(seen) and np.ptp(seen) * rate >= LEAST_IN_SECTION:
            phases = [2 * np.pi * h * rate * at for h in waves]
            parts += [np.where(m, g(x), 0.0) for x in phases for g in (np.cos, np.sin)]
    return np.column_stack(parts) if parts else np.zeros((len(problem.t), 0))


def _spans(problem: Problem) -> list[float]:
    """Fitted seconds of every section."""
    t, run = problem.t[problem.train], problem.run[problem.train]
    return [float(np.ptp(t[run == k])) for k in np.unique(run)]


def is_seen(problem: Problem, rate: float) -> bool:
    """Whether one section holds turns enough of a part, or all sections together that show its phase."""
    turns = [span * rate for span in _spans(problem)]
    return max(turns, default=0.0) >= LEAST_TURNS or sum(x for x in turns if x >= LEAST_IN_SECTION) >= IN_ALL


def longest_span(problem: Problem) -> float:
    """Fitted seconds of the longest section: a period must be seen again within one section."""
    return max(_spans(problem), default=0.0)


def part_candidates(problem: Problem, mount: Mount, part: Part, counts: Sequence[int]) -> list[Candidate]:
    """One part with different numbers of harmonics, with and without those of another part's turn."""
    place: dict[str, Any] = {"stage": part.name, "harmonic": 1, "order": part.rate * SIDEREAL_DAY_S}
    others = [other.rate for other in mount.parts if mount.named and other is not part]
    cell = 1.0 / max(longest_span(problem), 1e-9)

    def apart(h: int) -> bool:
        return h == 1 or all(abs(h * part.rate - rate) > cell for rate in others)

    seen = [count for count in counts if part.rate * count < 0.4 / problem.period_s]
    # a wheel that turns at a multiple of the worm may have that harmonic, or the worm itself
    sets = {tuple(h for h in range(1, n + 1) if every or apart(h)) for n in seen for every in (True, False)}
    return [c for waves in sorted(sets) for c in _periodic(problem, part.effect, part.rate, waves, **place)]


def _periodic(problem: Problem, name: str, rate: float, waves: Sequence[int], **more: Any) -> list[Candidate]:
    """A period of `rate` 1/s with its harmonics, where a section shows it; `more`: `Candidate`'s fields."""
    columns, size = harmonics(problem, rate, waves), ("amplitude", problem.unit)
    line = candidate(name, columns, size, kind="line", frequency=rate, **more)
    return [line] if line.width else []


def best_count(problem: Problem, selection: Selection, mount: Mount, part: Part) -> list[Candidate]:
    """An accepted part with as many harmonics as predict best the pieces that they were not fitted to.

    A worm's error is a periodic function, not a sine. Its first harmonics establish the period. How many of
    them to keep is a question of prediction.
    """

    def left(c: Candidate) -> float:
        x = np.hstack([problem.base, c.columns])
        return cross_validate(problem, problem.base, x, selection.after.whitener).after

    every = part_candidates(problem, mount, part, range(1, HARMONICS + 1))
    return [min(every, key=left)] if every else []


def worms(problem: Problem, drifting: Callable[[float], Problem], mount: Mount) -> Selection:
    """The parts that are found.

    `drifting` gives the problem in which all that takes longer than two of a period, s, is drift: twice the
    slowest that was found.
    """
    slowest, span = mount.periods_s[-1], longest_span(problem)
    seen = [part for part in mount.parts if is_seen(problem, part.rate)]
    s = _search(problem, mount, seen, span)
    while s.chosen:
        found = max(1.0 / (c.candidate.frequency or 1.0) for c in s.chosen)
        if found >= NEXT * slowest:
            break
        quicker = [part for part in seen if part.rate * found > AS_QUICK]
        again = _search(drifting(found), mount, quicker, span)
        if not again.chosen:
            break
        again.refused = s.refused + again.refused
        s, slowest = again, found
    return s


def _search(problem: Problem, mount: Mount, seen: list[Part], span: float) -> Selection:
    """Select parts with a few numbers of harmonics and free periods, then give each part its best number."""
    candidates = [c for part in seen for c in part_candidates(problem, mount, part, (1, 2, 5, HARMONICS))]
    candidates += free_periods(problem, mount, span)
    s = settle(problem, candidates, mount.named)
    by_name = {part.name: part for part in seen}
    for chosen in list(s.chosen):
        stage = chosen.candidate.stage
        if stage in by_name:
            kept = {x.candidate.key for x in s.chosen if x is not chosen}
            other = [x for x in candidates if x.key in kept]
            other += best_count(problem, s, mount, by_name[stage])
            again = settle(problem, other, mount.named)
            if again.held.after <= s.held.after:
                s, candidates = again, other
    return s


def findings(s: Selection, mount: Mount, span: float) -> list[Finding]:
    """Every part and period that was found, with its neighbours within the resolution and a wheel that is
    assumed in its note. `span` is in s, as in `longest_span`."""
    out = []
    for f in (finding_of(s, k) for k, c in enumerate(s.candidates) if c.frequency):
        others = [
            part.name
            for part in mount.parts
            if f.frequency and part.name != f.stage and abs(part.rate - f.frequency) * span < 0.5
        ]
        remarks = ["within this log's resolution also " + ", ".join(others[:3])] if others else []
        if f.stage and not mount.named:
            remarks.insert(0, ASSUMED)
            f = replace(f, equivalent=[UNKNOWN] if others else [])  # any period is next to some usual wheel
        out.append(replace(f, note="; ".join(remarks)))
    return out


def free_periods(problem: Problem, mount: Mount, span: float) -> list[Candidate]:
    """Periods that no known part has, between two turns in a section and five frames a turn."""
    if span <= 0:
        return []
    waves = HARMONICS if mount.named else 1  # of a wheel that is only assumed, the turn alone
    taken = [h * part.rate for part in mount.parts for h in range(1, (waves if part.worm else 2) + 1)]
    rates = np.arange(LEAST_TURNS / span, min(0.2 / problem.period_s, 80 / span), 0.3 / span)
    free = [float(rate) for rate in rates if all(abs(rate - k) * span > APART_TURNS for k in taken)]
    return [c for rate in free for c in _periodic(problem, UNKNOWN, rate, (1,), domain="time")]


def sections_of(problem: Problem, rate: float) -> int:
    """Sections that have columns of a period of `rate` 1/s."""
    return int(harmonics(problem, rate, (1,)).shape[1]) // 2


def _harmonic_leads(s: Selection, k: int) -> bool:
    """Whether a part's first harmonic is not its largest, over all sections."""
    sections = sections_of(s.problem, s.candidates[k].frequency or 0.0)
    sizes = np.hypot(*np.moveaxis(s.sizes(k).reshape(sections, -1, 2), 2, 0)).mean(axis=0)
    return bool(sizes.argmax() > 0)


def _elsewhere(s: Selection, k: int) -> list[Candidate]:
    """A period next to a free one that fits better; next to a part's, that predicts clearly better."""
    p, c, beside = s.problem, s.candidates[k], s.without(k).columns
    rate = _rate(c)

    def turning(at: float) -> Array:
        return np.hstack([beside, harmonics(p, at, (1,))])

    def left(at: float) -> float:
        x, y = turning(at)[p.train], p.y[p.train]
        return float(np.sum((y - x @ solve(x, y)) ** 2))

    best = min((rate + x / longest_span(p) for x in NEAR), key=left)
    if abs(best / rate - 1) <= (KEPT if c.stage else 0.0):
        return []
    better = not c.stage or cross_validate(p, turning(rate), turning(best), s.after.whitener).sure
    return _periodic(p, UNKNOWN, best, (1,), domain="time") if better else []


def settle(problem: Problem, candidates: list[Candidate], named: bool) -> Selection:
    """Select; what takes too little off the held-out frames is left out and the selection made again. So is
    a part whose turn is another period's."""
    refused, tried = list[Refusal](), len(candidates)
    while True:
        s = select(problem, candidates, most=2, before=tried - len(candidates))
        idle, moved = set(), list[Candidate]()
        for k, x in enumerate(s.chosen):
            own = named and x.candidate.stage
            part, free = (PART_GAIN, "a part of this mount"), (FREE_GAIN, "a period that was tried")
            least, what = part if own else free
            held = compare(problem, s.without(k).model, s.model, s.after.whitener)  # lines come together
            took = f"takes {100 * max(held.share, 0.0):.0f} % off the held-out mean square"
            why = f"{took}; {what} must take {100 * least:.0f} %" if not held.share > least else ""
            if not why and held.z < LUCK_Z:
                why = f"{took}, within luck (z = {held.z:.1f})"
            if not why and x.candidate.stage and not named and _harmonic_leads(s, k):
                why = "a harmonic is larger than the turn itself, on a wheel that is only assumed"
            if not why and (other := _elsewhere(s, k)):
                moved += other
                better = f"a period of {1 / _rate(other[0]):.1f} s predicts better"
                why = better if x.candidate.stage else ""
            if why:
                refused.append(Refusal(x.candidate.say(), why))
                idle.add(x.candidate.key)
        if not idle and not moved:
            s.refused = refused + s.refused
            return s
        near = 1.0 / longest_span(problem)
        kept = (c for c in candidates if c.stage or all(abs(_rate(c) - _rate(m)) >= near for m in moved))
        candidates = [*(c for c in kept if c.key not in idle), *moved]


def _rate(c: Candidate) -> float:
    """Turns per second of a period."""
    return c.frequency or 0.0
