"""What a declared controller does not explain of its own command: disturbances in front of the logged effort,
gains that are others or follow the speed."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.law import Command, command_of, declared_terms
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.decide.parameters import interval
from calibration.decide.select import Selection, select
from calibration.finding import Finding, Parameter
from calibration.names.command_disturbance import lines
from calibration.names.scene import Scene
from calibration.response.harmonics import findings_of
from calibration.statistics.regression import gls, solve

ANOTHER = 0.2  # of a declared gain: less is calibration, as for the axis' declared numbers
# of the mean square that the declared gains leave of held-out rows, at least, by which others must be better:
# where both leave the same, the log does not tell them apart (ASSUMPTION)
BETTER = 0.1
FEWEST = 60  # held-out rows, to judge on them
TOLD, CLEAR = 0.02, 5.0  # of a declared gain, and standard errors: less is not told
BEFORE = "in front of the logged effort: the law makes no such command"
FORWARD = "follows the reference, not the error: a feed-forward that the rig file does not declare?"
# of the moving rows, below whose speed the gains may be others: low ones and close ones (development
# seeds 1055, 1056 and 1062)
PARTS = (0.03, 0.06, 0.1, 0.15, 0.2, 0.25, 0.35, 0.5, 0.75)


@dataclass
class Law:
    """The command's selection, its gains, what was found, and what is told of the gains."""

    selection: Selection
    gains: dict[str, Parameter]
    findings: list[Finding] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def look_at_law(view: View, balance: Problem, seed: int) -> Law | None:
    """None where the rig file declares no controller."""
    law = view.rig.controller
    if law is None:
        return None
    c = command_of(view, balance, law)
    offered = [*_lines(view, c), *_by_speed(view, c), _forward(view, c)]
    s = select(c.problem, offered, np.random.default_rng(seed))
    out = Law(s, _gains(c), [f for k in range(len(s.chosen)) for f in findings_of(s, k)])
    for f in out.findings:
        forward = f.domain == "reference"
        f.domain = "command" if f.name == "unknown" else f.domain
        f.note = f.note or (FORWARD if forward else BEFORE)
    if not any(f.name == "unknown" for f in out.findings):  # else the law has no one set of gains
        _tell(out, c, declared_terms(law))
    return out


def _better(c: Command, declared: dict[str, float]) -> float:
    """Share of the mean square that the declared gains leave of the held-out rows, which the fitted ones take
    away; offsets are fitted anew for both."""
    p = c.problem
    test = p.test if p.test.sum() >= FEWEST else p.train
    plain = p.y + c.terms @ (c.gains - np.array(list(declared.values())))
    left = [e - p.base @ solve(p.base[p.valid], e[p.valid]) for e in (plain, p.y)]
    was, now = (float(np.mean(e[test] ** 2)) for e in left)
    return 1 - now / was if was > 0 else 0.0


def _gains(c: Command) -> dict[str, Parameter]:
    """The gains as parameters: a law is computed exactly, so their error is the log's alone."""
    blocks = max(int(c.problem.train.sum() / c.problem.block), 5)
    out = {}
    for k, (name, unit) in enumerate(c.labels):
        value, error = float(c.gains[k]), float(np.sqrt(max(c.covariance[k, k], 0.0)))
        out[name] = Parameter(value, unit, *interval(value, error, blocks, 0.0))
    return out


def _tell(law: Law, c: Command, declared: dict[str, float]) -> None:
    """Tell gains that are not the declared ones, when the command of held-out rows is theirs; beyond a fifth
    it is a finding."""
    if _better(c, declared) < BETTER:
        return
    for k, (name, unit) in enumerate(c.labels):
        value, error = float(c.gains[k]), float(np.sqrt(max(c.covariance[k, k], 0.0)))
        off = value - declared[name]
        if declared[name] == 0 or abs(off) < TOLD * abs(declared[name]) or abs(off) < CLEAR * error:
            continue
        part = off / declared[name]
        text = f"controller: {name} is {value:.4g} {unit} ({100 * part:+.1f} % of the declared one)"
        law.notes.append(text)
        if abs(part) > ANOTHER:
            evidence = min((off / max(error, 1e-300)) ** 2 / 4.6, 1e4)
            law.findings.append(Finding("unknown", "S", "command", evidence=evidence, share=1.0, note=text))


def _lines(view: View, law: Command) -> list[Candidate]:
    """The lines that a balance of forces is offered, of what the law leaves; no mode of a plant is among the
    names of a command."""
    p = law.problem
    e = gls(p.y, p.base, p.train, p.ar_order, p.block).residual
    scene = Scene(view, p, {}, e, np.zeros((len(p.y), 0)))
    found = lines(scene, law.follows @ law.gains)
    return [replace(c, labels=(("amplitude", p.unit),), twins=()) for c in found]


def _by_speed(view: View, c: Command) -> list[Candidate]:
    """Gains that are others below a speed, of the reference or of the drive (gain scheduling); it has no name
    in the catalogue."""
    p = c.problem
    labels = tuple((f"{name}_below", unit) for name, unit in c.labels)
    rates = {
        "reference_speed_limit": view.at(view.rate(view.columns["reference"])),
        "speed_limit": view.speed[view.rows],
    }
    out = []
    for name, rate in rates.items():
        speed = np.abs(rate)
        moving = speed[p.train & (speed > view.slow)]
        if len(moving) < 100:
            continue
        for limit in np.quantile(moving, PARTS):
            fixed = {name: (float(limit), f"{view.angle_unit}/s")}
            below = c.terms * (speed < limit)[:, None]
            out.append(Candidate("unknown", "velocity", below, labels, fixed=fixed))
    return out


def _forward(view: View, c: Command) -> Candidate:
    """A feed-forward that the file does not declare, beside the gains that had to stand for it."""
    unit = c.problem.unit
    rate = f"{unit} s/{view.angle_unit}"
    labels = [(f"{name}_beside", unit) for name, unit in c.labels]
    labels += [("rate_feedforward", rate), ("acceleration_feedforward", rate.replace(" s/", " s2/"))]
    labels += [("friction_feedforward", unit)]
    return Candidate("unknown", "reference", np.hstack([c.follows, c.forward]), tuple(labels))
