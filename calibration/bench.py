"""The rig pipeline: any other drive's table, its declared model from the rig file, and what is left."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from calibration.candidates import friction, lines, unknown
from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.channels.problem import Problem
from calibration.channels.rig import rig_problem
from calibration.decide.finding import Finding
from calibration.decide.heldout import HeldOut
from calibration.decide.parameters import finding_of
from calibration.decide.select import Selection, design, select
from calibration.readers.rig import Rig
from calibration.readers.run import Run

MOST = 10  # effects: a cogging motor shows several orders
LINES = ("gear_eccentricity", "gear_mesh", "motor_cogging", "bearing_pass")


@dataclass
class BenchResult:
    """The rig pipeline's findings for the report."""

    problem: Problem
    context: Context
    selection: Selection
    findings: list[Finding]
    held_out: list[str]
    not_identifiable: list[str]


def analyse_bench(runs: list[Run], rig: Rig, hold_out: list[str], seed: int = 0) -> BenchResult:
    """Select effects on the rig's response."""
    problem, c = rig_problem(runs, rig, hold_out)
    names = {s.name: s.kind or "gear_eccentricity" for s in rig.stages}
    candidates: list[Candidate] = [
        *friction.asymmetry(c),
        *friction.stribeck(c),
        *friction.presliding(c),
        *friction.position_friction(c),
        *friction.slow_changes(c),
        *lines.stage_lines(c, {s.name: s.harmonics for s in rig.stages}, names),
        *lines.free_lines(c),
    ]
    rng = np.random.default_rng(seed)
    s = select(problem, candidates, rng, most=MOST, margin=0.02)
    findings = [_name(finding_of(s, k), c) for k in range(len(s.chosen))]
    # only what the catalogue leaves may be called unknown: a smooth function can imitate most of its names
    more = select(
        replace(problem, base=design(problem, [x.candidate for x in s.chosen])),
        unknown.smooth_functions(c),
        rng,
        most=1,
    )
    s.refused += more.refused
    if more.chosen:
        findings.append(finding_of(more, 0))
        s = _together(s, more)
    return BenchResult(problem, c, s, findings, _held_names(problem, runs, rig), _missing(problem, c, s))


def _together(s: Selection, more: Selection) -> Selection:
    """The named effects and the unnamed function as one selection, so that table and pictures agree."""
    share = 1 - (more.held.after / s.held.before) ** 2
    return replace(
        s,
        chosen=[*s.chosen, *more.chosen],
        classes=[*s.classes, *more.classes],
        steps=[*s.steps, *more.steps],
        after=more.after,
        held=HeldOut(s.held.before, more.held.after, s.held.z, share),
    )


def _name(f: Finding, c: Context) -> Finding:
    """A line at an order that no stage has is a bearing only when the gear table is there to say so."""
    if f.name == "bearing_pass" and f.order:
        f.note = f"period {1 / f.order:.5g} {c.angle_unit}"
        if not c.stages:
            f.name, f.stage = "gear_eccentricity", None
            f.equivalent = list(dict.fromkeys([*f.equivalent, *(n for n in LINES if n != f.name)]))
            f.note += "; no gear table was given, so its stage cannot be named"
    return f


def _held_names(problem: Problem, runs: list[Run], rig: Rig) -> list[str]:
    names = []
    for k in np.unique(problem.run[problem.held]):
        rows = (problem.run == k) & problem.held
        whole = rows.sum() == (problem.run == k).sum()
        file = runs[int(problem.session[rows][0])].name
        names.append(file if whole else f"{file} run {int(k) + 1} from {problem.t[rows].min():.4g} s")
    return names


INFLATION = (
    30.0  # of a parameter's variance by its neighbours: more than five times the error it would have alone
)


def _missing(problem: Problem, c: Context, s: Selection) -> list[str]:
    """Parameters whose columns this motion does not move apart; from the columns, not from the response."""
    names = [label for label, _ in problem.base_labels]
    for x in s.chosen:
        if x.candidate.kind != "line" and x.candidate.name != "unknown":
            names += [f"{label} of {x.candidate.name}" for label, _ in x.candidate.labels]
    named = [x.candidate for x in s.chosen if x.candidate.kind != "line" and x.candidate.name != "unknown"]
    columns = design(problem, named)[problem.train]
    size = np.linalg.norm(columns, axis=0)
    out = [name for name, v in zip(names, size, strict=True) if v == 0]
    at = np.flatnonzero(size > 0)
    z = columns[:, at] / size[at]
    inverse = np.linalg.pinv(z.T @ z, hermitian=True)
    likeness = np.abs(z.T @ z) - np.eye(len(at))
    for k, v in enumerate(np.diag(inverse)):
        if v > INFLATION:
            out.append(f"{names[at[k]]} (moves with {names[at[int(np.argmax(likeness[k]))]]})")
    if min(np.mean(c.direction > 0), np.mean(c.direction < 0)) < 0.05:
        out.append("anything odd in direction: one direction only")
    return out
