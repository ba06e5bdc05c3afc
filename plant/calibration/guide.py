"""The guide-log pipeline: drive error of a guided mount over time, its worm and what the worm does not
explain."""

from __future__ import annotations

import re
from dataclasses import dataclass

import numpy as np

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.channels.problem import Problem
from plant.calibration.decide.finding import Finding
from plant.calibration.decide.parameters import finding_of
from plant.calibration.decide.select import Selection, select
from plant.calibration.errors import CalibrationInputError
from plant.calibration.readers.rig import Rig
from plant.calibration.readers.run import Array, Run

SIDEREAL_DAY_S = 86164.0905
#: mount name in the log -> teeth of its RA worm wheel (makers' data sheets)
MOUNTS = (
    (r"astro.?physics|\bAP ?(900|1100|1200|1600)|GTO", (225,)),
    (r"HEQ5|SkyScan.*HEQ", (135, 180)),
    (r"EQ6|AZ-?EQ|Atlas|CGEM", (180,)),
    (r"EQ8", (435,)),
    (r"G11|Gemini|Losmandy", (360,)),
    (r"CEM60|CEM70", (216,)),
    (r"CGX|AVX|CGE", (180,)),
    (r"Paramount|MYT|TheSkyX|TheSky", (576, 375)),
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


def guide_problem(runs: list[Run], hold_out: list[str]) -> tuple[Problem, list[str]]:
    """Drive error over time, with an offset per segment and a drift per section; raises when it is too
    short."""
    y, t, run, segment, held = [], [], [], [], []
    names, count, offset = [], 0, 0.0
    units = {r.header.get("unit", "arcsec") for r in runs}
    if len(units) > 1:
        raise CalibrationInputError(
            runs[0].path, "logs with and without a pixel scale cannot be put together"
        )
    period = float(np.median(np.concatenate([np.diff(r.columns["t"]) for r in runs if r.rows > 2])))
    for k, r in enumerate(runs):
        grid = np.arange(r.columns["t"][0], r.columns["t"][-1] + 1e-9, period)
        near = np.searchsorted(r.columns["t"], grid)
        near = np.clip(near, 1, r.rows - 1)
        close = (
            np.minimum(np.abs(r.columns["t"][near] - grid), np.abs(r.columns["t"][near - 1] - grid))
            < 1.5 * period
        )
        value = np.interp(grid, r.columns["t"], r.columns["ra"])
        y.append(np.where(close, value, np.nan))
        t.append(grid - grid[0] + offset)
        part = r.columns["segment"][near].astype(int)
        segment.append(part + count)
        count += int(part.max()) + 1
        run.append(np.full(len(grid), k))
        test = np.zeros(len(grid), dtype=bool)
        if hold_out:
            test[:] = bool({r.name, r.path.name, str(r.path)} & set(hold_out))
            names += [r.name] if test.all() else []
        elif len(runs) < 3:
            test[int(0.6 * len(grid)) :] = True
            names.append(f"{r.name} from {0.6 * (grid[-1] - grid[0]):.0f} s")
        elif k == len(runs) - 1:
            test[:] = True
            names.append(r.name)
        held.append(test)
        offset = t[-1][-1] + 20 * period
    yy, tt, rr = np.concatenate(y), np.concatenate(t), np.concatenate(run).astype(np.int64)
    ss, hh = np.concatenate(segment), np.concatenate(held)
    columns, labels, fresh = [], [], []
    for s in np.unique(ss):
        columns.append((ss == s).astype(float))
        labels.append(("offset", next(iter(units))))
        fresh.append((ss == s).astype(float))
    for k in range(len(runs)):
        m = rr == k
        columns.append(np.where(m, tt - tt[m].mean(), 0.0))
        labels.append(("drift", f"{next(iter(units))}/s"))
        if (m & hh).all():
            fresh.append(columns[-1])
    valid = np.isfinite(yy)
    problem = Problem(
        "K",
        next(iter(units)),
        np.where(valid, yy, 0.0),
        np.column_stack(columns),
        labels,
        tt,
        rr,
        rr,
        valid,
        hh,
        period,
        ar_order=3,
        block_s=max(12 * period, 40.0),
        sensor="position",
        fresh=np.column_stack(fresh),
    )
    steps = np.diff(yy)
    steps = steps[np.isfinite(steps)]
    problem.floor = (
        float(np.median(np.abs(steps - np.median(steps))) * 1.4826 / np.sqrt(2)) if len(steps) else 0.0
    )
    return problem, names


def worms(runs: list[Run], rig: Rig | None) -> dict[str, float]:
    """Turns per second of every periodic part that is known: from the rig, the mount's name, else usual
    wheels."""
    if rig is not None:
        return {s.name: 1.0 / s.period_s for s in rig.stages if s.period_s}
    mount = " ".join(r.header.get("mount", "") for r in runs)
    for pattern, teeth in MOUNTS:
        if re.search(pattern, mount, re.IGNORECASE):
            return {f"worm of a {n}-tooth wheel": n / SIDEREAL_DAY_S for n in teeth}
    return {f"worm of a {n}-tooth wheel": n / SIDEREAL_DAY_S for n in COMMON}


def harmonics(problem: Problem, rate: float, count: int) -> Array:
    """cos, sin of the first `count` harmonics per session: the worm's phase is a nuisance of the session."""
    parts = []
    for k in np.unique(problem.session):
        m = problem.session == k
        for h in range(1, count + 1):
            x = 2 * np.pi * h * rate * problem.t
            parts += [np.where(m, np.cos(x), 0.0), np.where(m, np.sin(x), 0.0)]
    return np.column_stack(parts)


def analyse_guide(runs: list[Run], rig: Rig | None, hold_out: list[str], seed: int = 0) -> GuideResult | str:
    """Run the pipeline; a text when the log is too short to say anything."""
    problem, names = guide_problem(runs, hold_out)
    if problem.train.sum() < 100:
        return f"{int(problem.train.sum())} frames to fit are too few to say anything (at least 100)"
    stages = worms(runs, rig)
    span = float(np.ptp(problem.t[problem.train]))
    short = [n for n, rate in stages.items() if span * rate < LEAST_TURNS]
    candidates = []
    for name, rate in stages.items():
        if name in short:
            continue
        for count in (1, 2, 5, HARMONICS):
            if rate * count < 0.4 / problem.period_s:
                candidates.append(
                    Candidate(
                        "gear_eccentricity",
                        "axis_angle",
                        harmonics(problem, rate, count),
                        (("amplitude", problem.unit),),
                        kind="line",
                        stage=name,
                        harmonic=1,
                        order=rate * SIDEREAL_DAY_S,
                        frequency=rate,
                    )
                )
    known = [h * r for r in stages.values() for h in range(1, HARMONICS + 1)]
    for rate in np.arange(LEAST_TURNS / span, min(0.2 / problem.period_s, 80 / span), 0.3 / span):
        if all(abs(rate - k) * span > 0.4 for k in known):
            candidates.append(
                Candidate(
                    "unknown",
                    "time",
                    harmonics(problem, float(rate), 2),
                    (("amplitude", problem.unit),),
                    kind="line",
                    frequency=float(rate),
                )
            )
    s = select(problem, candidates, np.random.default_rng(seed), most=2)
    findings = [finding_of(s, k) for k in range(len(s.chosen))]
    for f in findings:
        others = [
            n for n, r in stages.items() if f.frequency and n != f.stage and abs(r - f.frequency) * span < 0.5
        ]
        if others:
            f.note = "within this log's resolution also " + ", ".join(others[:3])
    missing = [f"{n}: fewer than {LEAST_TURNS:.0f} turns in the log" for n in short]
    return GuideResult(problem, s, findings, stages, names, missing)
