"""One response of a rig: columns that are late, the declared terms, names, what is left of it."""

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from calibration.arrays import Array
from calibration.balances.balance import problem_of
from calibration.balances.floors import floor_of, resolved_rows
from calibration.balances.problem import Problem
from calibration.balances.slowoffset import offset_order, slowness
from calibration.balances.view import View, fade
from calibration.decide.controls import controls, order_beside
from calibration.decide.onecolumn import by_one_column
from calibration.decide.parameters import findings_of
from calibration.decide.residual import beyond_names, left_over, of_one_domain, quick_lines, settle
from calibration.decide.selection import Selection
from calibration.decide.thresholds import AS_MUCH
from calibration.decide.twins import told_by_the_clock, told_by_the_speed, told_by_the_way, weight_first
from calibration.decide.verdict import ROWS
from calibration.decide.withdraw import as_told, of_calibrated, unnamed
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.inputs.run import Run
from calibration.look.delay import Found, Make, Timed, timed
from calibration.look.event import leave_out_event
from calibration.look.fewvalues import MOVES, few_values
from calibration.look.gap import crossed_first, where_known
from calibration.look.looked import Balance, Options, Spectrum, calibrated
from calibration.look.loopslaw import follows, law_of_its_loop
from calibration.look.said import close, filtered, lacking_names, moves_with, place_of, wound_up
from calibration.look.search import find, scene_of
from calibration.look.settled import doubts, one_filter, sharpest, turned
from calibration.look.slips import slipped

SWAYS = 6  # waves that a zero may make within a file: along more moves it follows none. ASSUMPTION
WANDERS = 2.0  # times the rms between files, that a zero may wander within one. ASSUMPTION
#: of a finding
OWN = (
    "every file has a constant of its own, as another weight, pressure or zero: declare offset_per_file, or"
    " the force as applied"
)


def look_at_forces(view: View, records: list[Run], options: Options) -> Balance:
    """The view's response, a force or one sensor against another."""
    made = partial(problem_of, view, records, options.hold_out)
    if view.dynamic:
        one_filter(view, made)
        fade(view, sharpest(view, made))
    few, motion = few_values(view, records, made)
    problem = made()
    if few := few or law_of_its_loop(view, problem, floor_of(view, problem)[0]):
        bare = Selection.of(problem)
        return Balance(key=problem.channel, row=ROWS[problem.channel], selection=bare, needs=[few])
    notes = turned(view, problem, made)
    when, remarks = _found(view, made)
    event = leave_out_event(view, made, when.found[0]) if view.response.is_force else None
    if event is not None:
        view.slow_offset = None
        if view.dynamic:
            fade(view, sharpest(view, made))
        when, remarks = _found(view, made)
    told = _told(view, when, notes)
    law = follows(view, made(), told.selection.held.after) if told.missing else []
    findings = [*told.findings, event] if event else told.findings
    remarks = [*filter(None, [motion]), *remarks, *told.remarks, *law, *doubts(view, told)]
    return replace(told, findings=findings, remarks=remarks)


def _found(view: View, made: Make) -> tuple[Timed, list[str]]:
    """The selection with the effort where it belongs, and remarks on an offset that wanders.

    An effect that begins at some time looks like a walk before it has a name: the offset is tried at rest.
    """
    response, remarks = view.response, list[str]()

    def search(p: Problem) -> Found:
        floor, _ = floor_of(view, p)
        p.floor = floor or 0.0
        p.resolved = resolved_rows(view, p)
        return find(view, p)

    def attempt() -> Timed:
        whole = made(0.0)
        if not response.is_force:
            return slipped(whole, crossed_first(search(whole), view, search), view, search)
        moves = "applied" if response.channel == "acceleration" else response.channel
        if moves not in (*MOVES, "applied") or moves not in view.columns or not view.dynamic:
            return Timed(whole, search(whole))
        return timed(view, made, whole, moves, search)

    if response.is_force and not response.is_speed:
        problem = made(0.0)
        view.slow_offset, wander = offset_order(view, problem, scene_of(view, problem).wander)
    when = attempt()
    if view.slow_offset is not None:
        slow, view.slow_offset = view.slow_offset, None
        steady = attempt()
        if _instead(steady, when):
            when = steady
        else:
            view.slow_offset = slow
            remarks += [
                f"{response.channel}: its offset wanders by {wander:.2g} {response.unit} rms within a file."
                f" {slow} slow functions of time are fitted anew in every file, as the offset is"
            ] * (slow > 0)
    when = _sharper(when, view, made, attempt) if view.dynamic else when
    return (_apart(when, view, made, wander) if view.slow_offset == 0 else when), remarks


def _of_the_zero(f: Finding, effect: Array, offsets: Finding | None, view: View) -> Finding:
    """`f`, or an unknown where its effect (n,) over time is hardly larger than the files' constants differ.

    That zero may wander within a file, too. Along a few moves it follows their direction by chance.
    """
    slow = offsets is not None and f.domain == "time" and f.frequency is None and slowness(view) < SWAYS
    if offsets is None or not slow or np.std(effect) > WANDERS * offsets.parameters["rms"].value:
        return f
    alike = (f.name, *(x for x in f.equivalent if x != UNKNOWN))
    one = replace(f, name=UNKNOWN, equivalent=alike, parameters={})
    return one.noted("hardly larger than what the zero differs by from file to file")


def _apart(when: Timed, view: View, made: Make, size: float) -> Timed:
    """With the files' own constants, `size` rms, as a finding: the declared model has one for all of them."""
    view.slow_offset = None
    declared = Selection.of(made(0.0))
    view.slow_offset = 0
    share = 1 - (when.found[0].held.before / (declared.held.before or 1.0)) ** 2
    rms = {"rms": Parameter(size, view.unit)}
    first = Finding(UNKNOWN, "T", "time", parameters=rms, share=share, note=OWN)
    return replace(when, offsets=first, declared=declared)


def _instead(steady: Timed, slow: Timed) -> bool:
    """Whether effects of one size for all files explain what an offset fitted anew in every file does, or it
    explains nothing."""
    one, other = steady.found[0], slow.found[0]
    much = one.held.taken > AS_MUCH * (one.held.before**2 - other.left)
    return one.held.after <= other.held.after or (bool(one.chosen) and not other.chosen and much)


def _sharper(first: Timed, view: View, made: Make, attempt: Callable[[], Timed]) -> Timed:
    """The search again, where beside what was found friction turns otherwise, unless that leaves more."""
    shown = (view.standstill, view.direction)
    if first.found[0].chosen:
        fade(view, sharpest(view, made, first))
    if view.standstill != shown[0]:
        s = (again := attempt()).found[0]
        if s.chosen and s.held.after < first.found[0].held.after:
            return again
    view.standstill, view.direction = shown
    return first


def _told(view: View, when: Timed, notes: list[str]) -> Balance:
    """The parts of the answer: floor, names that stay, what no name explains, controls."""
    channel, unit = view.response.channel, view.angle_unit
    s, scene, bounds = when.found
    s = where_known(s, view)
    for told in (told_by_the_clock, told_by_the_way, told_by_the_speed, weight_first):
        s = told(s, scene)
    problem = s.problem
    floor, source = floor_of(view, problem)
    if floor and (wind := wound_up(view, s)):
        floor, source = float(np.hypot(floor, wind)), f"{source}, and the effort's through the wind-up"
    still = [] if np.any(np.abs(view.direction) > 0.5) else ["the position does not move"]
    through, most = filtered(view)
    notes = [*notes, *filter(None, [when.note, f"floor of {channel}: {source}", through]), *still]
    s, together, beyond = by_one_column(*beyond_names(s, scene), scene)
    named = [
        _of_the_zero(replace(f, share=x), s.effect(k)[problem.train], when.offsets, view)
        for k, x in enumerate(s.worth)
        for f in findings_of(s, k)
    ]
    findings = as_told(named, scene)
    findings = of_calibrated(findings, scene, problem.by_name(s.after.beta)) + beyond
    left = left_over(s, scene, floor)
    findings = settle(of_one_domain(findings, left), left, problem.channel)
    findings += quick_lines(view, problem.channel)
    tried = controls(s, order_beside(s, scene))
    needs = [] if floor and together.held.after <= floor else close(together)
    return Balance(
        key=problem.channel,
        row=ROWS[problem.channel],
        selection=together,
        floor=floor,
        before=None if when.declared is None else when.declared.held.before,
        declared=when.declared,
        findings=[*filter(None, [when.offsets, when.first]), *unnamed(findings, tried)],
        numbers=calibrated(s),
        controls=tried,
        missing=left_over(together, scene, floor),
        not_identifiable=[*moves_with(s, bounds), *bounds],
        needs=[*filter(None, [when.close]), *needs],
        notes=[*notes, *lacking_names(scene, scene.channel)],
        remarks=[through] if most and channel in view.columns else [],
        over=partial(place_of, view),
        spectrum=Spectrum(
            turns=view.x[view.rows],  # orders per position unit
            stages={g.name: 1 / g.period for g in view.rig.stages if g.period},
            label=f"cycles per {unit.removesuffix('s') if unit.endswith('turns') else unit}",
        ),
        direction=view.direction[view.rows],
    )
