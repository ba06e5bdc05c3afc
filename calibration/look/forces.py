"""One response of a rig: columns that are late, the declared terms, names, what is left of it."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.balance import problem_of, response_of
from calibration.balances.candidate import Candidate
from calibration.balances.floors import floor_of, passed, resolved_rows
from calibration.balances.problem import Problem
from calibration.balances.slowoffset import SLOW, offset_order
from calibration.balances.view import STANDSTILLS, View, fade
from calibration.decide.controls import controls, order_beside
from calibration.decide.parameters import findings_of
from calibration.decide.reported import as_told, of_calibrated
from calibration.decide.residual import beyond_names, left_over, quick_lines, settle
from calibration.decide.selection import Selection
from calibration.decide.twins import told_by_the_clock, weight_first
from calibration.decide.verdict import ROWS
from calibration.decide.withdraw import unnamed
from calibration.finding import UNKNOWN
from calibration.inputs.declaration import Response
from calibration.inputs.run import Run
from calibration.look.delay import Found, Make, Timed, left_by_the_declared, timed
from calibration.look.gap import crossed_first, where_known
from calibration.look.looked import Balance, Options, Spectrum, calibrated, missing_of
from calibration.look.onefilter import one_filter
from calibration.look.search import find, scene_of
from calibration.names import NAMES
from calibration.names.scene import Scene
from calibration.names.shaft_compliance import NAME as COMPLIANCE
from calibration.names.shaft_compliance import WINDS

# of a parameter's variance by its neighbours: over five times the error it would have alone. arithmetic
INFLATION = 30.0
# that had evidence and failed elsewhere, as `Refusal.why` begins
CLOSE = ("cross-validated gain is within luck", "makes the held-out", "no held-out")


def look_at_forces(view: View, records: list[Run], options: Options) -> Balance:
    """The view's response, a force or one sensor against another."""
    response, tell, unit = view.response, options.tell, view.angle_unit

    def made(delay_s: float = 0.0) -> Problem:
        return problem_of(view, records, options.hold_out, delay_s)

    if view.dynamic:
        one_filter(view, made)
        fade(view, _sharpest(view, made))
    problem = made()
    if few := _few_values(records, response, problem):
        bare = Selection.of(problem)
        return Balance(key=problem.channel, row=ROWS[problem.channel], selection=bare, needs=[few])
    notes, remarks = [], []
    if _acts_on_the_drive(view, problem):
        view.response = replace(response, gain=-response.gain)
        problem = made()
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
        return find(view, p, tell)

    def attempt() -> Timed:
        whole = made()
        if response.channel not in ("effort", "current", "force") or not view.dynamic:
            return Timed(whole, crossed_first(search(whole), view, search))
        tell(f"{response.channel}: delay")
        return timed(view, made, whole, response.channel, search)

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
        when = _sharper(when, view, made, attempt)
    (s, scene, bounds), delay = when.found, when.delay
    notes += [when.note] if when.note else []
    s = weight_first(told_by_the_clock(where_known(s, view), scene), scene)
    problem = s.problem
    floor, source = floor_of(view, problem)
    wind = wound_up(view, s) if floor else 0.0
    if wind and floor:
        floor, source = float(np.hypot(floor, wind)), f"{source}, and the effort's through the wind-up"
    notes += [f"floor of {response.channel}: {source}", *_filtered(view)]
    if not np.any(np.abs(view.direction) > 0.5):
        notes.append("the position does not move")
    tell(f"{response.channel}: what no name explains")
    s, together, beyond = beyond_names(s, scene)
    findings = as_told([f for k in range(len(s.chosen)) for f in findings_of(s, k)], scene)
    findings = of_calibrated(findings, scene, problem.by_name(s.after.beta)) + beyond
    findings = settle(findings, left_over(s, scene, floor), problem.channel) + quick_lines(view, problem)
    tried = controls(s, order_beside(s, scene))
    close = [] if floor and together.held.after <= floor else _close(together)
    return Balance(
        key=problem.channel,
        row=ROWS[problem.channel],
        selection=together,
        floor=floor,
        before=when.before,
        findings=[*([delay] if delay is not None else []), *unnamed(findings, tried)],
        numbers=calibrated(s),
        controls=tried,
        missing=missing_of(left_over(together, scene, floor), problem.channel, response.channel),
        not_identifiable=[*_open(s, bounds), *bounds],
        needs=[*([when.close] if when.close else []), *close],
        notes=[*notes, *lacking_names(scene, scene.channel)],
        remarks=remarks,
        over=lambda c: place_of(view, c),
        spectrum=Spectrum(
            turns=view.x[view.rows],  # orders per position unit
            stages={g.name: 1 / g.period for g in view.rig.stages if g.period},
            label=f"cycles per {unit.removesuffix('s') if unit.endswith('turns') else unit}",
        ),
        direction=view.direction[view.rows],
    )


def _filtered(view: View) -> list[str]:
    """What share of the response's own column the filter takes away before anything is looked at."""
    y = response_of(view, 0.0)[0]
    rows = view.rows[view.ok[view.rows]]
    if view.filter.sigma <= 0 or len(rows) < 2 or np.var(y[rows]) == 0:
        return []
    lost = 1 - float(np.var(view.filter(y, view.segment)[rows]) / np.var(y[rows]))
    part = f"{100 * max(lost, 0.0):.3g} %"
    return [f"the filter takes {part} of the mean square of {view.response.channel} away"]


def _few_values(records: list[Run], response: Response, p: Problem) -> str:
    """Why a response of fewer values than the model has terms (a torque's steps) tests nothing, or empty."""
    logged = [r.columns[response.channel] for r in records if response.channel in r.columns]
    column = np.concatenate([x[np.isfinite(x)] for x in logged]) if logged else p.y
    values = len(np.unique(column))
    if values > p.base.shape[1]:
        return ""
    return (
        f"{response.channel} holds {values} values, the model has {p.base.shape[1]} terms: no balance"
        " can be tested with it; as response take a measured current or force"
    )


def lacking_names(scene: Scene, kind: str) -> list[str]:
    """Names that the log has not what they need for."""
    names = [n for n in NAMES.values() if kind in n.channels]
    return [f"not looked for: {n.name}: {why}" for n in names if (why := n.lacks(scene))]


def _close(s: Selection) -> list[str]:
    """Names (no smooth functions) that had evidence and failed elsewhere, each with its experiment."""
    out = []
    for r in s.refused:
        name = r.what.split(" on ")[0].split(",")[0]
        if r.why.startswith(CLOSE) and not r.what.startswith(UNKNOWN):
            hint = NAMES[name].experiment if name in NAMES else "repeat the run"
            out.append(f"{r.what} was close ({r.why}): {hint}")
    return out


def _open(s: Selection, bounds: list[str]) -> list[str]:
    """Parameters whose columns this motion does not move apart; from the columns, not from the response."""
    p = s.problem
    named = [x.candidate for x in s.chosen if x.candidate.kind != "line"]
    names = [label for label, _ in p.base_labels]
    names += [f"{label} of {c.name}" for c in named for label, _ in c.labels]
    columns = np.hstack([p.base, *[c.columns for c in named]])[p.train]
    size = np.linalg.norm(columns, axis=0)
    out = [
        n
        for n, v in zip(names, size, strict=False)
        if v == 0 and n != SLOW and not any(x.startswith(n + ":") for x in bounds)
    ]
    at = np.flatnonzero(size > 0)
    z = columns[:, at] / size[at]
    gram = z.T @ z
    likeness = np.abs(gram) - np.eye(len(at))
    for k, v in enumerate(np.diag(np.linalg.pinv(gram, hermitian=True))):
        if v > INFLATION and at[k] < len(names) and names[at[k]] != SLOW:
            out.append(f"{names[at[k]]} (moves with {names[at[int(np.argmax(likeness[k]))]]})")
    return out


def place_of(view: View, c: Candidate) -> tuple[Array, str]:
    """What an effect of a rig is drawn over."""
    at, unit = view.rows, view.angle_unit
    if c.repeats is not None:
        return (view.x[at] / (view.turn or 1.0) * c.repeats) % 1.0, f"phase of order {c.repeats:.5g}, turns"
    if c.frequency is not None:
        return (view.t[at] * c.frequency) % 1.0, f"phase of {c.frequency:.5g} Hz, turns"
    if c.domain == "temperature" and "temperature" in view.columns:
        return view.columns["temperature"][at], "temperature, degC"
    table = {
        "axis_angle": (view.x, f"position, {unit}"),
        "velocity": (view.speed, f"speed, {unit}/s"),
        "reversal": (view.since, f"travel since reversal, {unit}"),
    }
    x, label = table.get(c.domain, (view.clock, "time, s"))
    return x[at], label


def wound_up(view: View, s: Selection) -> float:
    """rms, in the response's unit, of the effort's own noise through a shaft's wind-up that was found: its
    column is noisy, the shaft winds up by the torque; 0 where none was."""
    for c, beta in s.fitted:
        if c.name == COMPLIANCE.name:
            channel = next(k for k in WINDS if k in view.columns)
            return abs(float(beta[0])) * (passed(view, view.columns[channel]) or 0.0)
    return 0.0


def _sharpest(view: View, made: Make, known: Timed | None = None) -> float:
    """How sharply friction turns with the speed, of STANDSTILLS: by what the declared terms leave on fitted
    rows, beside the effects of `known` where there is something."""
    shown = (view.standstill, view.direction)
    delay = known.delay.parameters["delay"].value if known is not None and known.delay is not None else 0.0
    s = known.found[0] if known is not None else None
    effects = sum(s.effect(k) for k in range(len(s.chosen))) if s is not None else 0.0
    left = []
    for part in STANDSTILLS:
        fade(view, part)
        p = made(delay)
        left.append(left_by_the_declared(view, replace(p, y=p.y - effects)))
    view.standstill, view.direction = shown
    return STANDSTILLS[int(np.argmin(left))]


def _sharper(first: Timed, view: View, made: Make, attempt: Callable[[], Timed]) -> Timed:
    """The search again, where beside what was found friction turns otherwise, unless that leaves more."""
    shown = (view.standstill, view.direction)
    fade(view, _sharpest(view, made, first))
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
    rows, x = problem.train, problem.base
    if view.turn:  # a weight that nobody declared must not turn the sign
        angle = view.x[view.rows] / view.turn * 2 * np.pi
        x = np.column_stack([x, np.cos(angle), np.sin(angle)])
    beta = np.linalg.lstsq(x[rows], problem.y[rows], rcond=1e-8)[0]
    share = {
        n: float(beta[k] * np.std(x[rows, k]))
        for k, (n, _) in enumerate(problem.base_labels)
        if n in ("inertia", "viscous", "coulomb")
    }
    return bool(share) and sum(share.values()) < 0 and max(share.values()) < -0.2 * min(share.values())
