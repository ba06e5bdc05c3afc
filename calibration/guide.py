"""The guide-log pipeline: drive error of a guided mount over time, its worm and what the worm does not
explain."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.guide import guide_problem, named, usable
from calibration.channels.problem import Problem
from calibration.decide.finding import Finding
from calibration.decide.heldout import cross_validate
from calibration.decide.parameters import finding_of
from calibration.decide.select import Refusal, Selection, select
from calibration.readers.rig import Rig
from calibration.readers.run import Array, Run

SIDEREAL_DAY_S = 86164.0905
#: mount name in the log -> teeth of its RA worm wheel (makers' data sheets; the periods listed in the PHD2
#: project's wiki, "Mount Worm Period Info", are the sidereal day over these)
MOUNTS = (
    (r"astro.?physics|\bAP ?(900|1100|1200|1600)|GTO", (225,)),
    (r"HEQ5|Sirius|SkyScan.*HEQ", (135, 180)),
    (r"Celestron.*AVX/", (180, 144)),  # one driver for the whole family
    (r"EQ6|AZ-?EQ|Atlas|CGEM|CPC|LX200|EM-?200|EM-?400", (180,)),
    (r"EQ8", (435,)),
    (r"G11|Gemini|Losmandy", (360,)),
    (r"CEM60|CEM70", (216,)),
    (r"\bAVX|Advanced VX|CEM25", (144,)),
    (r"iEQ45", (256,)),
    (r"CGX|CGE", (180,)),
    (r"Paramount|MYT|TheSkyX|TheSky", (576, 375, 320)),
)
COMMON = (
    130,
    135,
    144,
    180,
    192,
    216,
    225,
    288,
    359,
    360,
    435,
)  # wheels of mounts in use, tried when none is named
LEAST_IN_SESSION = 1.2  # turns in a section's training part for its own phase to mean anything
LEAST_GAIN = 0.02  # of the held-out mean square
LEAST_ROWS = 100  # frames to fit
IDLE = f"takes less than {100 * LEAST_GAIN:.0f} % off the held-out frames"
ON_THE_CLOCK = (
    "whole sections are held out: the worm's phase is carried there by the clock, which a slew breaks;"
    " without --hold-out the end of every section is held out"
)
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


def worms(runs: list[Run], rig: Rig | None) -> dict[str, float]:
    """Turns per second of every periodic part that is known: from the rig, the mount's name, else usual
    wheels."""
    if rig is not None:
        return {s.name: 1.0 / s.period_s for s in rig.stages if s.period_s}
    teeth = known_mount(runs) or COMMON
    return {f"worm of a {n}-tooth wheel": n / SIDEREAL_DAY_S for n in teeth}


def known_mount(runs: list[Run]) -> tuple[int, ...]:
    """Teeth that go with the mount's name in the log; empty when the name is not known."""
    mount = " ".join(r.header.get("mount", "") for r in runs)
    return next((teeth for pattern, teeth in MOUNTS if re.search(pattern, mount, re.IGNORECASE)), ())


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


def worm_candidates(problem: Problem, name: str, rate: float, counts: tuple[int, ...]) -> list[Candidate]:
    """One worm with different numbers of harmonics."""
    return [
        Candidate(
            "gear_eccentricity",
            "axis_angle",
            columns,
            (("amplitude", problem.unit),),
            kind="line",
            stage=name,
            harmonic=1,
            order=rate * SIDEREAL_DAY_S,
            frequency=rate,
        )
        for count in counts
        if rate * count < 0.4 / problem.period_s and (columns := harmonics(problem, rate, count)).shape[1] > 0
    ]


def best_count(problem: Problem, selection: Selection, name: str, rate: float) -> int:
    """Harmonics of an accepted worm that predict best the training pieces they were not fitted to.

    A worm's error is a periodic function, not a sine: its first harmonics establish the period, how many of
    them to keep is a question of prediction.
    """
    left: dict[int, tuple[float, int]] = {}
    for c in worm_candidates(problem, name, rate, tuple(range(1, HARMONICS + 1))):
        x = np.hstack([problem.base, c.columns])
        score = cross_validate(problem, problem.base, x, selection.after.whitener)
        left[c.width] = (score.after, len(left) + 1)
    return min(left.values())[1] if left else 1


def analyse_guide(runs: list[Run], rig: Rig | None, hold_out: list[str], seed: int = 0) -> GuideResult | str:
    """Run the pipeline; a text when the log is too short to say anything."""
    runs, notes = usable(runs, hold_out)
    if not runs or not any(not named(r, hold_out) for r in runs):
        return "no section is long enough to say anything"
    problem, names = guide_problem(runs, hold_out)
    if problem.train.sum() < LEAST_ROWS:
        return f"{int(problem.train.sum())} frames to fit are too few to say anything (at least {LEAST_ROWS})"
    if problem.domains:
        notes.append(ON_THE_CLOCK)
    stages = worms(runs, rig)
    span = longest_span(problem)
    short = [n for n, rate in stages.items() if span * rate < LEAST_TURNS]
    candidates = [
        c
        for name, rate in stages.items()
        if name not in short
        for c in worm_candidates(problem, name, rate, (1, 2, 5, HARMONICS))
    ]
    candidates += free_periods(problem, stages, span)
    s = settle(problem, candidates, seed)
    for chosen in list(s.chosen):
        c = chosen.candidate
        if c.stage and c.frequency:
            count = best_count(problem, s, c.stage, c.frequency)
            kept = {x.candidate.key for x in s.chosen if x is not chosen}
            candidates = [x for x in candidates if x.key in kept]
            candidates += worm_candidates(problem, c.stage, c.frequency, (count,))
            s = settle(problem, candidates, seed)
    findings = [finding_of(s, k) for k in range(len(s.chosen))]
    assumed = rig is None and not known_mount(runs)
    for f in findings:
        others = [
            n for n, r in stages.items() if f.frequency and n != f.stage and abs(r - f.frequency) * span < 0.5
        ]
        remarks = ["within this log's resolution also " + ", ".join(others[:3])] if others else []
        if f.stage and assumed:
            remarks.insert(
                0, "the log names no mount that is known here: the wheel is the usual one that fits"
            )
        f.note = "; ".join(remarks)
    missing = [f"{n} (fewer than {LEAST_TURNS:.0f} turns in one section's fitted part)" for n in short]
    return GuideResult(problem, s, findings, stages, names, missing, notes)


def free_periods(problem: Problem, stages: dict[str, float], span: float) -> list[Candidate]:
    """Periods that no known part has, between two turns in a section and five frames a turn."""
    if span <= 0:
        return []
    known = [h * r for r in stages.values() for h in range(1, HARMONICS + 1)]
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
        if all(abs(rate - k) * span > 0.4 for k in known)
        and (columns := harmonics(problem, float(rate), 2)).shape[1] > 0
    ]


def settle(problem: Problem, candidates: list[Candidate], seed: int) -> Selection:
    """Select; what takes nothing off the held-out frames is left out and the selection made again."""
    while True:
        s = select(problem, candidates, np.random.default_rng(seed), most=2)
        idle = {x.candidate.key for x, h in zip(s.chosen, s.steps, strict=True) if not h.share > LEAST_GAIN}
        if not idle:
            return s
        candidates = [c for c in candidates if c.key not in idle]
        s.refused += [Refusal(x.candidate.say(), IDLE) for x in s.chosen if x.candidate.key in idle]
