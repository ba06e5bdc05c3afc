"""The guide-log pipeline: drive error of a guided mount over time, its worm and what the worm does not
explain."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.guide import SLOWEST_S, guide_problem, named, usable
from calibration.channels.problem import Problem
from calibration.decide.heldout import cross_validate
from calibration.decide.judge import Refusal
from calibration.decide.parameters import amplitude_interval, finding_of
from calibration.decide.select import Selection, select
from calibration.drift.mounts import SIDEREAL_DAY_S, Part, known_mount, parts
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Rig
from calibration.readers.run import Array, Run

LEAST_IN_SESSION = 1.2  # turns in a section's training part for its own phase to mean anything
# of the held-out mean square, that a part of the mount in the log must take away, and one of eleven usual
# wheels or any free period: on 30 worm-free logs with slow quasi-periodic wander (seeds 0 to 29 of
# tests/calibration/guidelogs.py) three of these took 9 to 27 %, the worms of the measured logs 81 to 98 %
TOLD_GAIN = 0.15
TRIED_GAIN = 0.35
LEAST_ROWS = 100  # frames to fit
ON_THE_CLOCK = (
    "whole sections are held out: the worm's phase is carried there by the clock, which a slew breaks;"
    " without --hold-out the end of every section is held out"
)
NEXT = 0.9  # of the slowest period looked for: a found one below it lets more be drift
LEAST_TURNS = 2.0  # worm turns in the training span below which a worm cannot be told from drift
HARMONICS = 8


@dataclass
class GuideResult:
    """The guide pipeline's findings for the report."""

    problem: Problem
    selection: Selection
    findings: list[Finding]
    stages: dict[str, float]  # name -> turns per second
    held_out: list[str]
    not_identifiable: list[str]
    notes: list[str]


def harmonics(problem: Problem, rate: float, count: int) -> Array:
    """cos, sin of the first `count` harmonics per session: the worm's phase is a nuisance of the session.

    A session with less than LEAST_IN_SESSION turns to fit has none: offset and drift would imitate them.
    """
    parts = []
    at = problem.domains.get("clock", problem.t)
    for k in np.unique(problem.session):
        m = problem.session == k
        seen = at[m & problem.train]
        if len(seen) == 0 or np.ptp(seen) * rate < LEAST_IN_SESSION:
            continue
        for h in range(1, count + 1):
            x = 2 * np.pi * h * rate * at
            parts += [np.where(m, np.cos(x), 0.0), np.where(m, np.sin(x), 0.0)]
    return np.column_stack(parts) if parts else np.zeros((len(problem.t), 0))


def longest_span(problem: Problem) -> float:
    """Seconds of the longest section's training part: a period must be seen again within one section."""
    return max(
        (
            float(np.ptp(problem.t[m]))
            for k in np.unique(problem.run)
            if (m := (problem.run == k) & problem.train).any()
        ),
        default=0.0,
    )


def part_candidates(problem: Problem, part: Part, counts: tuple[int, ...]) -> list[Candidate]:
    """One part with different numbers of harmonics."""
    return [
        Candidate(
            "gear_eccentricity",
            "axis_angle",
            columns,
            (("amplitude", problem.unit),),
            kind="line",
            stage=part.name,
            harmonic=1,
            order=part.rate * SIDEREAL_DAY_S,
            frequency=part.rate,
        )
        for count in counts
        if part.rate * count < 0.4 / problem.period_s
        and (columns := harmonics(problem, part.rate, count)).shape[1] > 0
    ]


def best_count(problem: Problem, selection: Selection, part: Part) -> int:
    """Harmonics of an accepted part that predict best the training pieces they were not fitted to.

    A worm's error is a periodic function, not a sine: its first harmonics establish the period, how many of
    them to keep is a question of prediction.
    """
    left: dict[int, tuple[float, int]] = {}
    for c in part_candidates(problem, part, tuple(range(1, HARMONICS + 1))):
        x = np.hstack([problem.base, c.columns])
        score = cross_validate(problem, problem.base, x, selection.after.whitener)
        left[c.width] = (score.after, len(left) + 1)
    return min(left.values())[1] if left else 1


def analyse_guide(runs: list[Run], rig: Rig | None, hold_out: list[str], seed: int = 0) -> GuideResult | str:
    """Run the pipeline; a text when the log is too short to say anything."""
    runs, notes = usable(runs, hold_out)
    if not runs or not any(not named(r, hold_out) for r in runs):
        return "no section is long enough to say anything"
    known = parts(runs, rig)
    slowest = max((1.0 / part.rate for part in known), default=SLOWEST_S)
    quickest = min((1.0 / part.rate for part in known), default=SLOWEST_S)
    problem, names = guide_problem(runs, hold_out, slowest, quickest)
    if problem.train.sum() < LEAST_ROWS:
        return f"{int(problem.train.sum())} frames to fit are too few to say anything (at least {LEAST_ROWS})"
    if problem.domains:
        notes.append(ON_THE_CLOCK)
    span = longest_span(problem)
    short = [part for part in known if span * part.rate < LEAST_TURNS]
    seen = [part for part in known if part not in short]
    told = rig is not None or bool(known_mount(runs))
    s = _search(problem, seen, known, span, told, seed)
    while s.chosen:  # what is slower than twice the slowest that was found is drift, then
        found = max(1.0 / (c.candidate.frequency or 1.0) for c in s.chosen)
        if found >= NEXT * slowest:
            break
        quicker = guide_problem(runs, hold_out, found, quickest)[0]
        rest = [part for part in seen if part.rate * found > 0.99]
        again = _search(quicker, rest, known, span, told, seed)
        if not again.chosen:
            break
        again.refused = s.refused + again.refused
        problem, s, slowest = quicker, again, found
    findings = [_finding(s, k) for k in range(len(s.chosen))]
    for f in findings:
        f.note = _note(f, known, span, not told)
    few = f"fewer than {LEAST_TURNS:.0f} turns in one section's fitted part"
    lack = [f"{part.name} ({few})" for part in short]
    stages = {part.name: part.rate for part in known}
    return GuideResult(problem, s, findings, stages, names, lack, notes)


def _search(
    problem: Problem, seen: list[Part], known: list[Part], span: float, told: bool, seed: int
) -> Selection:
    """Select parts with a few numbers of harmonics and free periods, then give each part its best number."""
    candidates = [c for part in seen for c in part_candidates(problem, part, (1, 2, 5, HARMONICS))]
    candidates += free_periods(problem, known, span)
    s = settle(problem, candidates, told, seed)
    by_name = {part.name: part for part in seen}
    for chosen in list(s.chosen):
        stage = chosen.candidate.stage
        if stage in by_name:
            count = best_count(problem, s, by_name[stage])
            kept = {x.candidate.key for x in s.chosen if x is not chosen}
            candidates = [x for x in candidates if x.key in kept]
            candidates += part_candidates(problem, by_name[stage], (count,))
            s = settle(problem, candidates, told, seed)
    return s


def _note(f: Finding, known: list[Part], span: float, assumed: bool) -> str:
    """What the report says beside a finding: neighbours within the resolution, a wheel that is assumed."""
    others = [
        part.name
        for part in known
        if f.frequency and part.name != f.stage and abs(part.rate - f.frequency) * span < 0.5
    ]
    remarks = ["within this log's resolution also " + ", ".join(others[:3])] if others else []
    if f.stage and assumed:
        remarks.insert(0, "the log names no mount that is known here: the wheel is the usual one that fits")
    return "; ".join(remarks)


def _finding(s: Selection, k: int) -> Finding:
    """The finding with one amplitude per harmonic: the root mean square of its amplitudes in the sections,
    whose phases are each section's own."""
    found = finding_of(s, k)
    problem, c = s.problem, s.chosen[k].candidate
    sections = sum(
        1
        for one in np.unique(problem.session)
        if np.any(c.columns[(problem.session == one) & problem.train] != 0)
    )
    at = problem.base.shape[1] + sum(x.candidate.width for x in s.chosen[:k])
    blocks = int(problem.train.sum() / problem.block)
    count = c.width // (2 * max(sections, 1))
    parameters: dict[str, Parameter] = {}
    for h in range(count):
        spans = []
        for one in range(sections):
            pair = slice(at + 2 * (one * count + h), at + 2 * (one * count + h) + 2)
            spans.append(amplitude_interval(s.after.beta[pair], s.after.covariance[pair, pair], blocks))
        value, low, high = np.sqrt(np.mean(np.square(spans), axis=0))
        half = (high - low) / 2 / np.sqrt(sections)
        name = "amplitude" if h == 0 else f"amplitude_{h + 1}"
        low, high = max(float(value - half), 0.0), float(value + half)
        parameters[name] = Parameter(float(value), problem.unit, low, high)
    if sections == 1:
        parameters |= {n: p for n, p in found.parameters.items() if n.startswith("phase")}
    return replace(found, parameters=parameters)


def free_periods(problem: Problem, known: list[Part], span: float) -> list[Candidate]:
    """Periods that no known part has, between two turns in a section and five frames a turn."""
    if span <= 0:
        return []
    taken = [h * part.rate for part in known for h in range(1, (HARMONICS if part.worm else 2) + 1)]
    return [
        Candidate(
            "unknown",
            "time",
            columns,
            (("amplitude", problem.unit),),
            kind="line",
            frequency=float(rate),
        )
        for rate in np.arange(LEAST_TURNS / span, min(0.2 / problem.period_s, 80 / span), 0.3 / span)
        if all(abs(rate - k) * span > 0.4 for k in taken)
        and (columns := harmonics(problem, float(rate), 2)).shape[1] > 0
    ]


def least_gain(candidate: Candidate, told: bool) -> tuple[float, str]:
    """Share of the held-out mean square that a candidate must take away, and what it is."""
    if candidate.stage and told:
        return TOLD_GAIN, "a part of this mount"
    return TRIED_GAIN, "a period that was searched for"


def settle(problem: Problem, candidates: list[Candidate], told: bool, seed: int) -> Selection:
    """Select; what takes too little off the held-out frames is left out and the selection made again."""
    refused: list[Refusal] = []
    while True:
        s = select(problem, candidates, np.random.default_rng(seed), most=2)
        idle = set()
        for x, held in zip(s.chosen, s.steps, strict=True):
            least, what = least_gain(x.candidate, told)
            if not held.share > least:
                took = f"takes {100 * max(held.share, 0.0):.0f} % off the held-out mean square"
                refused.append(Refusal(x.candidate.say(), f"{took}; {what} must take {100 * least:.0f} %"))
                idle.add(x.candidate.key)
        if not idle:
            s.refused = refused + s.refused
            return s
        candidates = [c for c in candidates if c.key not in idle]
