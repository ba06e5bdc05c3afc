"""What a declared controller does not explain of its own command: disturbances in front of the logged effort,
gains that are others or follow the speed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.law import declared_terms, law_problem
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.decide.select import Selection, select
from calibration.finding import Finding
from calibration.harmonics import findings_of
from calibration.names import NAMES
from calibration.names.scene import Scene
from calibration.statistics.regression import gls

ANOTHER = 0.2  # of a declared gain: less is calibration, as for the axis' declared numbers
TOLD = 0.02  # of a declared gain, and two standard errors: what is told beside it
PARTS = (0.25, 0.5, 0.75)  # of the moving rows, below whose speed the gains may be others


@dataclass
class Law:
    """The command's selection, what was found, and what is told of the gains."""

    selection: Selection
    findings: list[Finding] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def look_at_law(view: View, balance: Problem, seed: int) -> Law | None:
    """None where the rig file declares no controller."""
    if view.rig.controller is None:
        return None
    p = law_problem(view, balance, view.rig.controller)
    s = select(p, [*_lines(view, p), *_by_speed(view, p)], np.random.default_rng(seed))
    out = Law(s, [f for k in range(len(s.chosen)) for f in findings_of(s, k)])
    for f in out.findings:
        f.domain = "command" if f.name == "unknown" else f.domain
        f.note = f.note or "in front of the logged effort: the law makes no such command"
    if not any(f.name == "unknown" for f in out.findings):  # else the law has no one set of gains
        _gains(out, declared_terms(view.rig.controller))
    return out


def _gains(law: Law, declared: dict[str, float]) -> None:
    """Tell gains that are not the declared ones; beyond a fifth it is a finding."""
    s = law.selection
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name not in declared or declared[name] == 0:
            continue
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        part = value / declared[name] - 1.0
        if abs(part) < TOLD or abs(value - declared[name]) < 2 * error:
            continue
        text = f"controller: {name} is {value:.4g} {unit} ({100 * part:+.1f} % of the declared one)"
        law.notes.append(text)
        if abs(part) > ANOTHER and abs(value - declared[name]) > 5 * error:
            evidence = ((value - declared[name]) / max(error, 1e-300)) ** 2 / 4.6
            law.findings.append(
                Finding("unknown", "S", "command", evidence=min(evidence, 1e4), share=1.0, note=text)
            )


def _lines(view: View, p: Problem) -> list[Candidate]:
    """The lines that a balance of forces is offered, of what the law leaves; no mode of a plant is among the
    names of a command."""
    e = gls(p.y, p.base, p.train, p.ar_order, p.block).residual
    scene = Scene(view, p, {}, e, np.zeros((len(p.y), 0)))
    found = NAMES["command_disturbance"].columns(scene)
    return [replace(c, labels=(("amplitude", p.unit),), twins=()) for c in found]


def _by_speed(view: View, p: Problem) -> list[Candidate]:
    """Gains that are others below a speed (gain scheduling); it has no name in the catalogue."""
    speed = np.abs(view.speed[view.rows])
    width = len(declared_terms(view.rig.controller)) if view.rig.controller is not None else 0
    moving = speed[p.train & (speed > view.slow)]
    if len(moving) < 100:
        return []
    labels = tuple((f"{name}_below", unit) for name, unit in p.base_labels[:width])
    return [
        Candidate(
            "unknown",
            "velocity",
            p.base[:, :width] * (speed < limit)[:, None],
            labels,
            fixed={"speed_limit": (float(limit), f"{view.angle_unit}/s")},
        )
        for limit in np.quantile(moving, PARTS)
    ]
