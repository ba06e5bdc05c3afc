"""A drive with a rig file: records, every response, the command, the volts."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from calibration.balances.agreement import Agreement, velocity_against_position
from calibration.balances.balance import problem_of
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_ROWS
from calibration.balances.view import WINDOW, View, view_of
from calibration.balances.volts import has_volts
from calibration.balances.width import NARROW
from calibration.decide.thresholds import STILL_MISSING
from calibration.errors import CalibrationInputError
from calibration.finding import UNKNOWN
from calibration.inputs.counters import align_counters
from calibration.inputs.declaration import Rig
from calibration.inputs.logs import Drive
from calibration.inputs.run import Run
from calibration.look.controllerlaw import look_at_law
from calibration.look.forces import look_at_forces
from calibration.look.looked import Balance, Looked, Options, unnamed_where_missing
from calibration.look.volts import FEW_VOLTS, look_at_volts
from calibration.names.channel_delay import against_position, late_column
from calibration.names.columns import repairs_found

REMARKED = ("saturation", "leap")  # repairs that change what a reader thinks the log is
MOST_NEEDS = 4  # that are reported: a longer sentence is not read. ASSUMPTION
SAME_HZ = 0.02  # of a frequency: two lines are one. ASSUMPTION


def look_at_response(drive: Drive, rig: Rig, options: Options) -> Looked:
    """Columns first, then every response of the rig file, then what commands and volts show."""
    records, tell = drive.records, options.tell
    _check(records, rig)
    align_counters(records, rig)
    views: list[View] = []
    balances: list[Balance] = []
    agreement = None
    for response in rig.responses:
        tell(f"{response.channel}: columns")
        view = view_of(records, rig, response)
        if not views:
            agreement = velocity_against_position(view, problem_of(view, records, options.hold_out).held)
        view, balance = _through_its_filter(view, records, options)
        balances.append(balance)
        views.append(view)
    held_out = list(_held_names(views[0], balances[0].selection.problem, records))
    best = next((k for k, v in enumerate(views) if v.dynamic), 0)  # its filter is made for rates
    view, problem = views[best], balances[best].selection.problem.once
    tell("command: the controller's law")
    law = look_at_law(view, problem)
    tell("voltage: winding and back-EMF")
    electric = look_at_volts(view, problem)
    short = [FEW_VOLTS] if electric is None and has_volts(view) else []
    effects = repairs_found(records, ("effort",) if law is not None and law.findings else ())
    if agreement is not None and agreement.late:
        note = against_position(agreement.channel, agreement.delay_s)
        effects.append(late_column(note, agreement.delay_s, agreement.error_s, share=0.0))
    effects += [f for b in balances for f in b.findings]
    if law is not None:
        # a line of the command that is one of a balance, too: the motion does not know of it either
        found = [f.frequency for f in effects if f.frequency is not None]
        own = ((f, f.frequency or 0.0) for f in law.findings)
        effects += [f for f, hz in own if not any(abs(x - hz) < SAME_HZ * hz for x in found)]
    effects += electric.findings if electric is not None else []
    effects.sort(key=lambda f: (f.of_column, f.name == UNKNOWN and not f.equivalent, -f.share))
    strange, a = [], agreement
    if a is not None and a.left > STILL_MISSING and not a.hardly:
        strange = [
            f"{a.channel} is not the position's rate ({a.left:.1f} floors apart): find out how it is made"
        ]
    needs = [*(x for b in balances for x in b.short), *strange, *(x for b in balances for x in b.needs)]
    lacks = list(dict.fromkeys(needs))[:MOST_NEEDS]
    balances += [b for b in (law, electric) if b is not None]
    effects, lacks = unnamed_where_missing(effects, lacks, balances)
    repairs = [(x.kind, f"{r.name}, {x.channel}: {x.note}") for r in records for x in r.repairs]
    start = [f"the files' starts are taken from {drive.clock}"] if len(records) > 1 else []
    scaled = [agreement.scaled] if agreement is not None and agreement.scaled else []
    return Looked(
        title=rig.name,
        balances=balances,
        effects=effects,
        needs=lacks,
        rows=_velocity(agreement),
        held_out=held_out,
        notes=[*start, *_gaps(records), *(note for kind, note in repairs if kind not in REMARKED)],
        remarks=[*(note for kind, note in repairs if kind in REMARKED), *strange, *scaled, *short],
    )


def _through_its_filter(view: View, records: list[Run], options: Options) -> tuple[View, Balance]:
    """The view's response. Where the usual filter shows nothing, as a narrower one does that shows a name."""
    rig, response = view.rig, view.response  # as they are declared: its sign may be turned
    balance = look_at_forces(view, records, options)
    if not balance.missing or _explains(balance):
        return view, balance
    finer = view_of(records, rig, response, NARROW)
    if finer.wide >= view.wide:
        return view, balance
    options.tell(f"{response.channel}: through a narrower filter")
    other = look_at_forces(finer, records, options)
    if not _names(other):
        return view, balance
    width = f"{WINDOW * view.wide * view.period_s:.3g} s"
    note = f"{response.channel}: behind the usual filter of {width} nothing shows; a narrower one is taken"
    return finer, replace(other, notes=[note, *other.notes])


def _names(b: Balance) -> bool:
    """Whether the response has an effect with a name."""
    return any(f.name != UNKNOWN and not f.of_column for f in b.findings)


def _explains(b: Balance) -> bool:
    """Whether what was found, with a name or without, takes anything off the held-out error."""
    return bool(b.error["after"] < b.error["before"])


def _check(records: list[Run], rig: Rig) -> None:
    """CalibrationInputError for records that are too short to say anything, all together."""
    rows = sum(r.rows for r in records)
    if rows < FEWEST_ROWS:
        few = f"{rows} rows are too few to say anything (at least {FEWEST_ROWS})"
        raise CalibrationInputError(records[0].path, few)
    for r in records:
        for key, value in (("smooth_s", rig.smooth_s), ("analyse_period_s", rig.analyse_period_s)):
            if value is not None and value > 0.02 * r.duration_s:
                long = f"{key}: {value:g} s is too long for a run of {r.duration_s:.4g} s"
                raise CalibrationInputError(rig.path, long)


def _velocity(a: Agreement | None) -> dict[str, dict[str, Any]]:
    """Row of the error table of a measured velocity against the position's rate, where it says something."""
    if a is None or not (a.late or a.left > STILL_MISSING) or not np.isfinite(a.before):
        return {}
    after, floor = (a.after if a.late else a.before), (a.floor if np.isfinite(a.floor) else None)
    return {"velocity": {"unit": a.unit, "before": a.before, "after": after, "floor": floor}}


def _held_names(view: View, p: Problem, records: list[Run]) -> Iterator[str]:
    if p.turned is not None:
        yield f"each of {len(records)} files in its turn"
    for k in np.unique(p.run[p.held]) if p.turned is None else ():
        rows = (p.run == k) & p.held
        whole = rows.sum() == (p.run == k).sum()
        file = records[int(p.session[rows][0])].name
        t = view.t[view.rows]
        to_end = not np.any(t[(p.run == k) & p.train] > t[rows].max())
        part = f"from {t[rows].min():.4g} s" + ("" if to_end else f" to {t[rows].max():.4g} s")
        yield file if whole else f"{file} run {int(k) + 1} {part}"


def _gaps(records: list[Run]) -> Iterator[str]:
    for name, gaps in ((r.name, r.gaps()) for r in records):
        if gaps:
            lost = sum(b - a for a, b in gaps)
            yield f"{name}: {len(gaps)} gap{'s' if len(gaps) > 1 else ''}, {lost:.3g} s without rows"
