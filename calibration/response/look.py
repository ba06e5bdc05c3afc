"""One way through for any drive with a rig file: records, columns that are late, balances, names."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calibration.channels.agreement import Agreement, velocity_against_position
from calibration.channels.balance import problem_of
from calibration.channels.drivenoise import passed, resolved_rows
from calibration.channels.floors import floor_of
from calibration.channels.problem import Problem
from calibration.channels.slowoffset import offset_order
from calibration.channels.view import STANDSTILLS, View, fade, view_of
from calibration.decide.judge import design
from calibration.decide.select import Selection, fitted
from calibration.errors import CalibrationInputError
from calibration.finding import Finding, Parameter
from calibration.inputs.declaration import Response, Rig
from calibration.inputs.origin import align_counters
from calibration.inputs.record import Record
from calibration.names import NAMES
from calibration.names.name import FORCE, SENSORS
from calibration.names.scene import Scene
from calibration.names.shaft_compliance import WINDS
from calibration.readers.run import Array
from calibration.response.delay import Found, Timed, left_by_the_declared, timed
from calibration.response.gap import crossed_first, where_known
from calibration.response.harmonics import findings_of
from calibration.response.law import Law, look_at_law
from calibration.response.left import Left, left_over, settle
from calibration.response.search import find, scene_of
from calibration.response.told import as_told, of_calibrated
from calibration.response.unnamed import beyond_names, quick_lines
from calibration.response.volts import Electric, look_at_volts

MIN_ROWS = 200  # fewer rows than this say nothing about ten parameters


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
    notes: list[str] = field(default_factory=list)  # what was settled before any name
    remarks: list[str] = field(default_factory=list)  # likewise, what no reader should miss
    left: Left | None = None
    close: str = ""  # of a delay that is neither named nor out of the question


@dataclass
class DriveResult:
    """Everything that the report says about a drive."""

    rig: Rig
    records: list[Record]
    balances: list[Balance]
    sensors: list[Finding]  # of columns and clocks, before any balance
    agreement: Agreement | None
    clock: str  # what the files' starts are taken from
    law: Law | None = None  # of a declared controller
    electric: Electric | None = None  # where volts and current are logged


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
    align_counters(records, rig)
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
    best = next((b for b in balances if b.view.dynamic), balances[0])  # its filter is made for rates
    tell("command: the controller's law")
    law = look_at_law(best.view, best.problem, seed)
    sensors = repairs_found(records, ("effort",) if law is not None and law.findings else ())
    if agreement is not None and agreement.late:
        sensors.append(_late(agreement))
    tell("voltage: winding and back-EMF")
    electric = look_at_volts(best.view, best.problem, seed)
    return DriveResult(rig, records, balances, sensors, agreement, clock, law, electric)


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
    if view.dynamic:
        fade(view, _sharpest(view, records, hold_out))
    problem = problem_of(view, records, hold_out)
    notes, remarks = [], []
    if _acts_on_the_drive(view, problem):
        view.response = replace(response, gain=-response.gain)
        problem = problem_of(view, records, hold_out)
        notes.append(
            f"{response.channel}: points against the motion, so it is what acts on the drive, or the position"
            " counts the other way; its sign is turned here, and so are the signs of what is found in it"
        )
    if view.dynamic:
        view.slow_offset, wander = offset_order(view, problem, scene_of(view, problem).wander)

    def search(p: Problem) -> Found:
        floor, _ = floor_of(view, p)
        p.floor = floor or 0.0
        p.resolved = resolved_rows(view, p)
        return find(view, p, seed, tell)

    def attempt() -> Timed:
        whole = problem_of(view, records, hold_out)
        if response.channel not in ("effort", "current", "force") or not view.dynamic:
            return Timed(whole, crossed_first(search(whole), view, search))
        tell(f"{response.channel}: delay")
        return timed(view, records, hold_out, whole, response.channel, search)

    when = attempt()
    if view.slow_offset:
        slow, view.slow_offset = view.slow_offset, 0
        steady = attempt()  # what begins at some time looks like a walk before it has a name
        if steady.found[0].chosen and steady.found[0].held.after < when.found[0].held.after:
            when = steady
        else:
            view.slow_offset = slow
            remarks.append(
                f"{response.channel}: its offset wanders by {wander:.2g} {response.unit} rms within a file;"
                f" {slow} slow functions of time are fitted anew in every file, as the offset is"
            )
    if view.dynamic and when.found[0].chosen:
        when = _sharper(when, view, records, hold_out, attempt)
    problem, (s, scene, bounds), delay, before = when.problem, when.found, when.delay, when.before
    notes += [when.note] if when.note else []
    s = where_known(s, view)
    problem = s.problem
    floor, source = floor_of(view, problem)
    wind = wound_up(view, s) if floor else 0.0
    if wind and floor:
        floor, source = float(np.hypot(floor, wind)), f"{source}, and the effort's through the wind-up"
    tell(f"{response.channel}: what no name explains")
    s, together, unnamed = beyond_names(s, scene, seed)
    findings = as_told([f for k in range(len(s.chosen)) for f in findings_of(s, k)], scene)
    final = {n: float(b) for (n, _), b in zip(problem.base_labels, s.after.beta, strict=False)}
    findings = of_calibrated(findings, scene, final)
    findings += unnamed
    findings = settle(findings, left_over(s, scene, floor), problem.channel) + quick_lines(view, problem)
    kind = FORCE if response.is_force else SENSORS
    lacks = [f"{n.name}: {n.lacks(scene)}" for n in NAMES.values() if kind in n.channels and n.lacks(scene)]
    return Balance(
        view,
        problem,
        scene,
        together,
        s,
        findings,
        floor,
        source,
        delay,
        before,
        lacks,
        bounds,
        notes,
        remarks,
        left_over(together, scene, floor),
        when.close,
    )


def wound_up(view: View, s: Selection) -> float:
    """rms, in the response's unit, of the effort's own noise through a shaft's wind-up that was found: its
    column is noisy, the shaft winds up by the torque; 0 where none was."""
    for c, beta in fitted(s):
        if c.name == "shaft_compliance":
            channel = next(k for k in WINDS if k in view.columns)
            return abs(float(beta[0])) * (passed(view, view.columns[channel], max(view.sigma, 1.0)) or 0.0)
    return 0.0


def _sharpest(view: View, records: list[Record], hold_out: list[str], known: Timed | None = None) -> float:
    """How sharply friction turns with the speed, of STANDSTILLS: by what the declared terms leave on fitted
    rows, beside the effects of `known` where there is something."""
    shown = (view.standstill, view.direction)
    delay = known.delay.parameters["delay"].value if known is not None and known.delay is not None else 0.0
    effects = _effects(known.found[0]) if known is not None else 0.0
    left = []
    for part in STANDSTILLS:
        fade(view, part)
        p = problem_of(view, records, hold_out, delay)
        left.append(left_by_the_declared(view, replace(p, y=p.y - effects)))
    view.standstill, view.direction = shown
    return STANDSTILLS[int(np.argmin(left))]


def _effects(s: Selection) -> Array:
    """(n_fitted,): what is found, in the response's unit."""
    first = s.problem.base.shape[1]
    return np.asarray(design(s.problem, [x.candidate for x in s.chosen])[:, first:] @ s.after.beta[first:])


def _sharper(
    first: Timed, view: View, records: list[Record], hold_out: list[str], attempt: Callable[[], Timed]
) -> Timed:
    """The search again, where what was found makes friction turn more or less sharply than without it; as it
    is when that leaves more."""
    shown = (view.standstill, view.direction)
    fade(view, _sharpest(view, records, hold_out, first))
    if view.standstill != shown[0]:
        again = attempt()
        if again.found[0].chosen and again.found[0].held.after < first.found[0].held.after:
            return again
    view.standstill, view.direction = shown
    return first


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
