"""One way through for any drive with a rig file: records, columns that are late, balances, names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calibration.channels.agreement import Agreement, velocity_against_position
from calibration.channels.balance import problem_of
from calibration.channels.floors import floor_of
from calibration.channels.problem import Problem
from calibration.channels.view import STANDSTILLS, View, fade, view_of
from calibration.decide.finding import Finding, Parameter
from calibration.decide.parameters import finding_of
from calibration.decide.select import Selection, design, select
from calibration.errors import CalibrationInputError
from calibration.harmonics import findings_of
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.record import Record
from calibration.names import NAMES
from calibration.names.lateness import effort_delay, is_hold
from calibration.names.name import FORCE, SENSORS
from calibration.names.scene import Scene
from calibration.names.unknown import flexible, plain, smooth_functions
from calibration.prune import prune

MOST = 14  # effects: a cogging motor shows several orders
MARGIN = 0.02  # of the cross-validated mean square (effects.md, lesson 3)
ROUNDS = 3  # of search: lines come out when larger things are gone
MIN_ROWS = 200  # fewer rows than this say nothing about ten parameters
LINES = ("gear_eccentricity", "gear_mesh", "motor_cogging", "bearing_pass")


@dataclass
class Balance:
    """One response: what was selected on it, and what it was selected from."""

    view: View
    problem: Problem
    scene: Scene
    selection: Selection
    named: Selection  # without the unnamed function: what the declared terms are read from
    findings: list[Finding]
    floor: float | None
    floor_from: str
    delay: Finding | None = None
    before: float | None = None  # held-out error before the delay was taken out
    lacks: list[str] = field(default_factory=list)
    bounds: list[str] = field(default_factory=list)


@dataclass
class DriveResult:
    """Everything that the report says about a drive."""

    rig: Rig
    records: list[Record]
    balances: list[Balance]
    sensors: list[Finding]  # of columns and clocks, before any balance
    agreement: Agreement | None
    clock: str  # what the files' starts are taken from


def analyse(
    records: list[Record],
    rig: Rig,
    hold_out: list[str],
    clock: str,
    tell: Callable[[str], None] = lambda _: None,
    seed: int = 0,
) -> DriveResult:
    """Columns first, then every response of the rig file."""
    for r in records:
        if r.rows < MIN_ROWS:
            raise CalibrationInputError(
                r.path, f"{r.rows} rows are too few to say anything (at least {MIN_ROWS})"
            )
        for key, value in (("smooth_s", rig.smooth_s), ("analyse_period_s", rig.analyse_period_s)):
            if value is not None and value > 0.02 * r.duration_s:
                raise CalibrationInputError(
                    rig.path, f"{key}: {value:g} s is too long for a run of {r.duration_s:.4g} s"
                )
    still = [g.name for g in rig.stages if not g.period]
    if still and all(r.channel != "position" for r in rig.responses):
        raise CalibrationInputError(
            rig.path,
            f"stages.{still[0]}: period_s is for a drive at constant rate (response: position); give period",
        )
    from calibration.names.columns import repairs_found

    balances = []
    agreement = None
    for k, response in enumerate(rig.responses):
        tell(f"{response.channel}: columns")
        view = view_of(records, rig, response)
        if k == 0:
            first = problem_of(view, records, hold_out)
            agreement = velocity_against_position(view, first.held)
        balances.append(_balance(view, records, response, hold_out, tell, seed))
    sensors = repairs_found(records)
    if agreement is not None and agreement.late:
        sensors.append(_late(agreement))
    return DriveResult(rig, records, balances, sensors, agreement, clock)


def _late(a: Agreement) -> Finding:
    gone = 1 - (a.after / a.before) ** 2
    half = 1.96 * a.error_s
    return Finding(
        "channel_delay",
        "S",
        "clock",
        evidence=(a.delay_s / max(a.error_s, 1e-300)) ** 2 / 4.6,
        share=gone,
        note=f"the {a.channel} column is {'late' if a.delay_s > 0 else 'early'} against the position",
        parameters={"delay": Parameter(a.delay_s, "s", a.delay_s - half, a.delay_s + half)},
    )


def _balance(
    view: View,
    records: list[Record],
    response: Response,
    hold_out: list[str],
    tell: Callable[[str], None],
    seed: int,
) -> Balance:
    rng = np.random.default_rng(seed)
    if view.dynamic:
        _sharpen(view, records, hold_out)
    problem = problem_of(view, records, hold_out)
    delay = None
    before = None
    notes = []
    if _acts_on_the_drive(view, problem):
        view.response = replace(response, gain=-response.gain)
        problem = problem_of(view, records, hold_out)
        notes.append(
            f"{response.channel}: points against the motion, so it is what acts on the drive, or the position"
            " counts the other way; its sign is turned here, and so are the signs of what is found in it"
        )
    if response.channel in ("effort", "current", "force") and view.dynamic:
        tell(f"{response.channel}: delay")
        scene = _scene(view, problem)
        delay = effort_delay(scene)
        if delay is not None:
            before = _held_rms(problem)
            problem = problem_of(view, records, hold_out, delay.parameters["delay"].value)
            if is_hold(delay, view.period_s):
                value = delay.parameters["delay"].value
                notes.append(
                    f"{response.channel}: acts {-value:.2g} s after its row: the hold of a sampled loop"
                )
                delay = before = None
    floor, source = floor_of(view, problem)
    problem.floor = floor or 0.0
    s, scene = _search(view, problem, rng, tell)
    bounds = _bound(s)
    if bounds:
        s, scene = _search(view, problem, rng, tell)
    findings = [_name(f, scene) for k in range(len(s.chosen)) for f in findings_of(s, k)]
    tell(f"{response.channel}: what no name explains")
    # only what the catalogue leaves may be called unknown: a smooth function can imitate most of its names
    more = select(
        replace(problem, base=design(problem, [x.candidate for x in s.chosen])),
        smooth_functions(scene),
        rng,
        most=1,
    )
    s.refused += more.refused
    together = s
    if more.chosen:
        findings.append(finding_of(more, 0))
        together = _together(s, more)
    kind = FORCE if response.is_force else SENSORS
    lacks = [f"{n.name}: {n.lacks(scene)}" for n in NAMES.values() if kind in n.channels and n.lacks(scene)]
    return Balance(
        view, problem, scene, together, s, findings, floor, source, delay, before, lacks, [*notes, *bounds]
    )


def _sharpen(view: View, records: list[Record], hold_out: list[str]) -> None:
    """Choose how sharply friction turns with the speed: by what the declared terms leave on fitted rows."""
    left = []
    for part in STANDSTILLS:
        fade(view, part)
        p = problem_of(view, records, hold_out)
        s = _scene(view, p)
        x = np.hstack([p.base, plain(s)])[p.train]
        beta = np.linalg.lstsq(x / np.maximum(np.linalg.norm(x, axis=0), 1e-300), p.y[p.train], rcond=1e-8)
        e = p.y[p.train] - x / np.maximum(np.linalg.norm(x, axis=0), 1e-300) @ beta[0]
        left.append(float(np.mean(e**2)))
    fade(view, STANDSTILLS[int(np.argmin(left))])


def _acts_on_the_drive(view: View, problem: Problem) -> bool:
    """Whether masses and friction, taken together, come out negative: the sign convention is the other."""
    if not view.response.is_force or view.response.channel == "acceleration":
        return False
    rows = problem.train
    weight = np.zeros((len(problem.y), 0))
    if view.turn:  # a weight that nobody declared must not turn the sign
        angle = view.x[view.rows] / view.turn * 2 * np.pi
        weight = np.column_stack([np.cos(angle), np.sin(angle)])
    x = np.hstack([problem.base, weight])
    beta = np.linalg.lstsq(x[rows], problem.y[rows], rcond=1e-8)[0]
    share = {
        n: float(beta[k] * np.std(x[rows, k]))
        for k, (n, _) in enumerate(problem.base_labels)
        if n in ("inertia", "viscous", "coulomb")
    }
    return bool(share) and sum(share.values()) < 0 and max(share.values()) < -0.2 * min(share.values())


def _bound(s: Selection) -> list[str]:
    """Masses and friction are not negative: a term that the final fit wants so is taken out of the balance,
    and said."""
    problem, out = s.problem, []
    for k, (name, _) in enumerate(problem.base_labels):
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        if name in ("inertia", "viscous", "coulomb") and value < 0 and problem.base[:, k].any():
            why = "" if value < -2 * error else ", within its error"
            out.append(f"{name}: the fit gives {value:.4g}{why}; a negative one feeds energy: kept at zero")
            problem.base = problem.base.copy()
            problem.base[:, k] = 0.0
    return out


def _scene(view: View, problem: Problem) -> Scene:
    """The declared terms' coefficients, and what a flexible fit leaves."""
    rows = problem.train
    beta = np.linalg.lstsq(problem.base[rows], problem.y[rows], rcond=None)[0]
    declared = {n: float(b) for (n, _), b in zip(problem.base_labels, beta, strict=True)}
    declared |= view.rig.constants
    scene = Scene(view, problem, declared, problem.y - problem.base @ beta, np.zeros((len(problem.y), 0)))
    scene.wander = flexible(scene)
    return scene


def _flatten(scene: Scene, extra: np.ndarray) -> None:
    """Residual of base, what is chosen and a flexible fit, on which lines are looked for."""
    p = scene.problem
    x = np.hstack([p.base, extra, scene.wander])
    size = np.linalg.norm(x[p.train], axis=0)
    x = x[:, size > 0] / size[size > 0]
    beta = np.linalg.lstsq(x[p.train], p.y[p.train], rcond=1e-8)[0]
    scene.residual = p.y - x @ beta


def _search(
    view: View, problem: Problem, rng: np.random.Generator, tell: Callable[[str], None]
) -> tuple[Selection, Scene]:
    """Select; look again for lines under what was found; select again from all."""
    kind = FORCE if view.response.is_force else SENSORS
    scene = _scene(view, problem)
    lines = {"bearing_pass", "command_disturbance"}
    named = [
        c
        for n in NAMES.values()
        if kind in n.channels and n.name not in lines and not (n.name == "channel_delay" and kind == FORCE)
        for c in n.columns(scene)
    ]
    found: list[object] = []
    s: Selection | None = None
    extra = np.zeros((len(problem.y), 0))
    for k in range(ROUNDS):
        tell(f"{view.response.channel}: names, round {k + 1}")
        _flatten(scene, extra)
        fresh = [
            c
            for name in sorted(lines)
            if kind in NAMES[name].channels
            for c in NAMES[name].columns(scene)
            if not _known(c, found, scene)
        ]
        if s is not None and not fresh:
            break
        found += fresh
        candidates = [*named, *found]
        s = select(problem, candidates, rng, most=MOST, margin=MARGIN)  # type: ignore[arg-type]
        extra = np.hstack([np.zeros((len(problem.y), 0)), *[x.candidate.columns for x in s.chosen]])
        if not any(x.candidate.name in lines for x in s.chosen) and k > 0:
            break
    assert s is not None
    return prune(s), scene


def _known(c: object, found: list[object], scene: Scene) -> bool:
    """A line that is on the list already."""
    for f in found:
        for name in ("order", "frequency"):
            a, b = getattr(c, name), getattr(f, name)
            reach = 1.0 / max(scene.span if name == "order" else float(scene.view.t.max()), 1e-12)
            if a is not None and b is not None and abs(a - b) < reach and c.columns.shape == f.columns.shape:  # type: ignore[attr-defined]
                return True
    return False


def _held_rms(problem: Problem) -> float:
    rows, train = problem.test, problem.train
    beta = np.linalg.lstsq(problem.base[train], problem.y[train], rcond=None)[0]
    return (
        float(np.sqrt(np.mean((problem.y - problem.base @ beta)[rows] ** 2))) if rows.any() else float("nan")
    )


def _together(s: Selection, more: Selection) -> Selection:
    """The named effects and the unnamed function as one selection, so that table and pictures agree."""
    share = 1 - (more.held.after / s.held.before) ** 2
    return replace(
        s,
        chosen=[*s.chosen, *more.chosen],
        classes=[*s.classes, *more.classes],
        steps=[*s.steps, *more.steps],
        after=more.after,
        held=replace(s.held, after=more.held.after, share=share, z=more.held.z),
    )


def _name(f: Finding, scene: Scene) -> Finding:
    """A line at an order that no stage has is a bearing only when the gear table is there to say so."""
    if f.name == "bearing_pass" and f.order:
        f.note = f"period {(scene.view.turn or 1.0) / f.order:.5g} {scene.angle_unit}"
        if not scene.view.rig.stages:
            f.name, f.stage = "gear_eccentricity", None
            f.equivalent = list(dict.fromkeys([*f.equivalent, *(n for n in LINES if n != f.name)]))
            f.note += "; no gear table was given, so its stage cannot be named"
    return f
