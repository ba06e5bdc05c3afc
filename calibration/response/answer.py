"""From what was found on a drive to a verdict with its error table, controls and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.answers import GATE, Answer, calibrated, gate_rows, refusals
from calibration.channels.slowoffset import SLOW
from calibration.decide.select import Selection
from calibration.decide.thresholds import STILL_MISSING
from calibration.decide.verdict import Verdict, judge
from calibration.finding import Finding
from calibration.names import NAMES
from calibration.response.left import Left
from calibration.response.look import Balance, DriveResult
from calibration.response.wrong import drive_controls

REMARKED = ("saturation", "leap")  # repairs that change what a reader thinks the log is
STRONG = 6.0  # -log10 p of a refused candidate that is told as having been close
ROW = {"T": "torque", "K": "position"}
SAME_HZ = 0.02  # of a frequency: two lines are one
INFLATION = 30.0  # of a parameter's variance by its neighbours: over five times the error it would have alone


def drive_answer(found: DriveResult, plots: bool) -> Answer:
    """Verdict, pictures and title."""
    effects = list(found.sensors)
    controls: list[dict[str, Any]] = []
    for b in found.balances:
        if b.delay is not None:
            effects.append(b.delay)
        rows = drive_controls(b)
        controls += rows
        effects += _withdrawn(b, rows)
    if found.law is not None:
        effects += [f for f in found.law.findings if not _told(f, effects)]
    if found.electric is not None:
        effects += found.electric.findings
    effects.sort(key=lambda f: (f.name == "unknown", f.share == 0.0, -f.share))
    verdict, separating = judge(
        effects, [*_short(found), *_strange_rate(found), *_much_left(found), *_close(found)][:4]
    )
    separating = _separating(effects) or separating if effects else separating
    lacking = [x for b in found.balances for x in b.lacks]
    lacking += [] if found.electric is None else found.electric.lacks
    first = found.balances[0]
    v = Verdict(
        verdict,
        effects,
        _errors(found),
        _held_names(first, found),
        {k: p for b in found.balances for k, p in calibrated(b.named).items() if _is_declared(b, k)},
        [x for b in found.balances for x in [*_missing(b), *b.bounds]],
        controls,
        separating,
        [*_reasons(found), *_remarks(found), *(f"not looked for: {x}" for x in lacking)],
        _remarks(found),
        thresholds=gate_rows(_selections(found)),
        refused=refusals(_selections(found)),
    )
    if found.law is not None:
        v.calibrated |= found.law.gains
    if found.electric is not None:
        v.calibrated |= calibrated(found.electric.named)
    from calibration.report.drivepictures import pictures

    return v, pictures(found, GATE) if plots else [], found.rig.name


def _told(line: Finding, effects: list[Finding]) -> bool:
    """Whether a line of the command is one of a balance: then the motion does not know of it either."""
    return line.frequency is not None and any(
        f.frequency is not None and abs(f.frequency - line.frequency) < SAME_HZ * line.frequency
        for f in effects
    )


def _selections(found: DriveResult) -> dict[str, Selection]:
    law = {} if found.law is None else {"U": found.law.selection}
    volts = {} if found.electric is None else {"E": found.electric.selection}
    return {_channel(b): b.selection for b in found.balances} | law | volts


def _channel(b: Balance) -> str:
    """Channel letter of a balance."""
    return b.problem.channel


def _withdrawn(b: Balance, rows: list[dict[str, Any]]) -> list[Finding]:
    """Findings of a balance; one whose control was accepted keeps no name."""
    out = []
    for f in b.findings:
        place = "" if f.stage is None else f" on {f.stage}"
        said = f.name + place + (f", harmonic {f.harmonic}" if f.harmonic else "")
        # a line without a stage may be told otherwise
        line = f"in place of {f.order:.4g} (" if f.order else None
        failed = [
            r
            for r in rows
            if r["accepted"] and (r["what"].endswith(f"({said})") or (line and line in r["what"]))
        ]
        if failed and f.name != "unknown":
            wrong = failed[0]["what"].split(" (")[0]
            f.note = f"{wrong} fits as well: the name {f.name} is withdrawn. {f.note}".strip()
            f.name, f.stage, f.harmonic, f.equivalent = "unknown", None, None, []
        out.append(f)
    return out


def _separating(effects: list[Finding]) -> str | None:
    """The experiments of the names that a log cannot tell apart."""
    names = [n for e in effects if e.equivalent for n in (e.name, *e.equivalent)]
    texts = [f"{n}: {NAMES[n].experiment}" for n in dict.fromkeys(names) if n in NAMES]
    return "; ".join(texts[:3]) or None


def _close(found: DriveResult) -> list[str]:
    """Names that had evidence and failed elsewhere, in balances that are not at their floor already. A smooth
    function of something is no name to look for with an experiment."""
    out = [b.close for b in found.balances if b.close]
    for b in found.balances:
        if b.floor and b.selection.held.after <= b.floor:
            continue
        for r in b.selection.refused:
            if r.what.startswith("unknown"):
                continue
            if r.what != "every candidate" and r.why.startswith(
                ("cross-validated gain is within luck", "makes the held-out", "no held-out")
            ):
                name = r.what.split(" on ")[0].split(",")[0]
                hint = NAMES[name].experiment if name in NAMES else "repeat the run"
                out.append(f"{r.what} was close ({r.why}): {hint}")
    return list(dict.fromkeys(out))


def _much_left(found: DriveResult) -> list[str]:
    """Balances that nothing explains and that are far above their floor: not "nothing"."""
    return [
        f"{left.times:.1f} floors remain in {where}, {left.where}: a column of what"
        " may drive it, or one quantity changed at a time"
        for where, left in _left(found)
    ]


def _left(found: DriveResult) -> list[tuple[str, Left]]:
    """Column, and what remains beyond its floors."""
    out = [(b.view.response.channel, b.left) for b in found.balances if b.left is not None]
    if found.electric is not None and found.electric.left is not None:
        out.append(("voltage", found.electric.left))
    return out


def _strange_rate(found: DriveResult) -> list[str]:
    """What remains between a measured velocity and the position's rate."""
    a = found.agreement
    if a is None or a.left <= STILL_MISSING:
        return []
    return [f"{a.left:.1f} floors remain between {a.channel} and the position's rate: what makes the column"]


def _scaled(found: DriveResult) -> list[str]:
    return [found.agreement.scaled] if found.agreement is not None and found.agreement.scaled else []


def _short(found: DriveResult) -> list[str]:
    return [r.why for b in found.balances for r in b.selection.refused if r.what == "every candidate"]


def _errors(found: DriveResult) -> dict[str, dict[str, Any]]:
    out: dict[str, dict[str, Any]] = {}
    for b in found.balances:
        held = b.selection.held
        if np.isfinite(held.before):
            before = b.before if b.before is not None else held.before
            out[ROW[b.problem.channel]] = {
                "unit": b.problem.unit,
                "before": before,
                "after": held.after,
                "floor": b.floor,
            }
    if found.law is not None:
        held, unit = found.law.selection.held, found.law.selection.problem.unit
        if np.isfinite(held.before):
            out["command"] = {"unit": unit, "before": held.before, "after": held.after, "floor": None}
    if found.electric is not None and np.isfinite(found.electric.selection.held.before):
        held, floor = found.electric.selection.held, found.electric.balance.floor
        out["electrical"] = {"unit": "V", "before": held.before, "after": held.after, "floor": floor}
    a = found.agreement
    if a is not None and (a.late or a.left > STILL_MISSING) and np.isfinite(a.before):
        out["velocity"] = {
            "unit": a.unit,
            "before": a.before,
            "after": a.after if a.late else a.before,
            "floor": a.floor if np.isfinite(a.floor) else None,
        }
    return out


def _is_declared(b: Balance, name: str) -> bool:
    """Leave out what the bounds took from the balance."""
    labels = [n for n, _ in b.problem.base_labels]
    return bool(b.problem.base[:, labels.index(name)].any())


def _held_names(b: Balance, found: DriveResult) -> list[str]:
    p, names = b.problem, []
    for k in np.unique(p.run[p.held]):
        rows = (p.run == k) & p.held
        whole = rows.sum() == (p.run == k).sum()
        file = found.records[int(p.session[rows][0])].name
        begin = float(b.view.t[b.view.rows][rows].min())
        names.append(file if whole else f"{file} run {int(k) + 1} from {begin:.4g} s")
    return names


def _missing(b: Balance) -> list[str]:
    """Parameters whose columns this motion does not move apart; from the columns, not from the response."""
    p = b.problem
    named = [x for x in b.named.chosen if x.candidate.kind != "line"]
    names = [label for label, _ in p.base_labels]
    for x in named:
        names += [f"{label} of {x.candidate.name}" for label, _ in x.candidate.labels]
    columns = np.hstack([p.base, *[x.candidate.columns for x in named]])[p.train]
    size = np.linalg.norm(columns, axis=0)
    out = [
        n
        for n, v in zip(names, size, strict=False)
        if v == 0 and n != SLOW and not any(x.startswith(n + ":") for x in b.bounds)
    ]
    at = np.flatnonzero(size > 0)
    z = columns[:, at] / size[at]
    gram = z.T @ z
    inverse = np.linalg.pinv(gram, hermitian=True)
    likeness = np.abs(gram) - np.eye(len(at))
    for k, v in enumerate(np.diag(inverse)):
        if v > INFLATION and at[k] < len(names) and names[at[k]] != SLOW:
            out.append(f"{names[at[k]]} (moves with {names[at[int(np.argmax(likeness[k]))]]})")
    return out


def _reasons(found: DriveResult) -> list[str]:
    out = []
    if len(found.records) > 1:
        out.append(f"the files' starts are taken from {found.clock}")
    for r in found.records:
        gaps = r.gaps()
        if gaps:
            lost = sum(b - a for a, b in gaps)
            out.append(f"{r.name}: {len(gaps)} gap{'s' if len(gaps) > 1 else ''}, {lost:.3g} s without rows")
        out += [f"{r.name}, {x.channel}: {x.note}" for x in r.repairs if x.kind not in REMARKED]
    out += found.electric.notes if found.electric is not None else []
    for b in found.balances:
        out += b.notes
        out.append(f"floor of {b.view.response.channel}: {b.floor_from}")
        out += _short(found)
        if not np.any(np.abs(b.view.direction) > 0.5):
            out.append("the position does not move")
    return out


def _remarks(found: DriveResult) -> list[str]:
    """What no reader of the verdict should miss: the terminal repeats it."""
    out = [f"{r.name}, {x.channel}: {x.note}" for r in found.records for x in r.repairs if x.kind in REMARKED]
    out += [*_strange_rate(found), *_scaled(found)]
    out += found.law.notes if found.law is not None else []
    out += [r for b in found.balances for r in b.remarks]
    for column, left in _left(found):
        where = f"{left.where} ({100 * left.share:.0f} % of it)" if left.domain else left.where
        out.append(f"{left.times:.1f} floors remain in {column}, {where}: something is still missing")
    return out
