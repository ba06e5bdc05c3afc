"""What a controller's law does not explain of its own command: disturbances, gains that are others or follow
the speed, pulses. A rig declares its law; an axis with two motors has the boards' incremental one."""

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate
from calibration.balances.effortchange import incremental_law, pulses
from calibration.balances.law import Command, Law, command_of, declared_terms
from calibration.balances.problem import Problem
from calibration.balances.thresholds import SLOWEST_LINE_HZ
from calibration.balances.view import View
from calibration.decide.parameters import findings_of, interval
from calibration.decide.select import select
from calibration.decide.thresholds import FEWEST_TOLD, NOISE_SHARE
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.look.axis_result import AxisResult
from calibration.look.looked import Balance
from calibration.names.command_disturbance import NAME as DISTURBANCE
from calibration.names.command_disturbance import lines
from calibration.names.lines import ON_CLOCK
from calibration.names.name import tried
from calibration.names.scene import Scene, since_first
from calibration.statistics.orders import Wanted, standing_out
from calibration.statistics.regression import solve

ANOTHER = 0.2  # of a declared gain: less is calibration, as for the axis' declared numbers. ASSUMPTION
# of the mean square that the declared gains leave of held-out rows, at least, by which others must be better:
# where both leave the same, the log does not tell them apart (ASSUMPTION)
BETTER = 0.1
REPORTED = 0.02  # share of a declared gain: less is not reported. ASSUMPTION
CLEAR = 5.0  # standard errors likewise. ASSUMPTION
BEFORE = "in front of the logged effort: the law makes no such command"
FORWARD = "follows the reference, not the error: a feed-forward that the rig file does not declare?"
# times what the rounding of the effort leaves of its change, before a law of its own is looked for: below, a
# law that fits better is how small numbers round (the plant's own logs: 1.0; a wrong gain: 1.9 and more).
# ASSUMPTION
LEAST_LAW = 1.2
# steps of the effort: a line on the command below the effort's own step is a beat of quantised columns.
# ASSUMPTION
LEAST_COMMAND = 0.8
STEP_CELLS = 0.5  # of a line's resolution cell (1 / span), for its refinement. ASSUMPTION


def look_at_law(view: View, balance: Problem) -> Balance | None:
    """The command's balance with its gains; None where the rig file declares no controller."""
    law = view.rig.controller
    if law is None:
        return None
    c = command_of(view, balance, law)
    p = c.problem
    scene = Scene(view, p, {}, p.fit().residual, np.zeros((len(p.y), 0)))
    waves = lines(scene, c.follows @ c.gains)  # no mode of a plant is among the names of a command
    plain = [replace(x, labels=(("amplitude", p.unit),), twins=()) for x in waves]
    s = select(p, [*plain, *changed_below(c), _forward(view, c)])
    findings = [_of_the_law(f) for k in range(len(s.chosen)) for f in findings_of(s, k)]
    remarks: list[str] = []
    if not any(f.name == UNKNOWN for f in findings):  # else the law has no one set of gains
        remarks, others = _others(c, declared_terms(law))
        findings += others
    numbers = {  # a law is computed exactly, so the error of its gains is the log's alone
        name: Parameter(x.value, unit, *interval(x.value, x.error, c.problem.blocks, 0.0))
        for (name, unit), x in zip(c.labels, c.sizes, strict=True)
    }
    return Balance(key="U", row="command", selection=s, findings=findings, numbers=numbers, remarks=remarks)


def _of_the_law(f: Finding) -> Finding:
    """With the plant's domain, and what it says of the law."""
    note = f.note or (FORWARD if f.domain == "reference" else BEFORE)
    return replace(f, domain="command" if f.name == UNKNOWN else f.domain, note=note)


def _others(c: Command, declared: dict[str, float]) -> tuple[list[str], list[Finding]]:
    """Gains other than declared, where held-out rows have them: in words, beyond ANOTHER as findings, too.
    Offsets are fitted anew for the declared and for the fitted ones."""
    p, said, found = c.problem, [], []
    test = p.test if p.test.sum() >= FEWEST_TOLD else p.train
    plain = p.y + c.terms @ (c.gains - np.array(list(declared.values())))
    left = [e - p.base @ solve(p.base[p.valid], e[p.valid]) for e in (plain, p.y)]
    was, now = (float(np.mean(e[test] ** 2)) for e in left)
    better = was > 0 and 1 - now / was >= BETTER
    for (name, unit), x in zip(c.labels, c.sizes, strict=True) if better else ():
        off = x.value - declared[name]
        if declared[name] == 0 or abs(off) < max(REPORTED * abs(declared[name]), CLEAR * x.error):
            continue
        part = off / declared[name]
        said.append(f"controller: {name} is {x.value:.4g} {unit} ({100 * part:+.1f} % of the declared one)")
        if abs(part) > ANOTHER:
            evidence = min(min(abs(off) / max(x.error, 1e-300), 1e3) ** 2 / 4.6, 1e4)
            found.append(Finding(UNKNOWN, "S", "command", evidence=evidence, share=1.0, note=said[-1]))
    return said, found


def command_channel(result: AxisResult) -> None:
    """Change of an axis' effort against the boards' law."""
    law = incremental_law(result.frame, result.held, result.declared.own)
    if law is None:
        return
    p = law.problem
    s = select(p, [*_lines_of_steps(p), *changed_below(law)], result.rng, margin=NOISE_SHARE)
    if s.chosen and s.candidates[0].name == UNKNOWN and s.held.before < LEAST_LAW * p.floor:
        s = select(p, [], result.rng)
    result.selections["U"] = s
    line = bool(s.chosen) and s.candidates[0].kind == "line"
    if not line or np.hypot(*s.sizes(0).reshape(-1, 2).T).max() > LEAST_COMMAND:
        result.collect(s)
    found = pulses(p, s.after.residual)
    result.findings += [] if found is None else [found]


def changed_below(law: Law) -> list[Candidate]:
    """The law with other gains below a limit of a rate (gain scheduling); it has no name in the catalogue."""
    labels = tuple((f"{name}_below", unit) for name, unit in law.labels)
    return [
        Candidate(UNKNOWN, "command", below, labels, fixed={name: (limit, rate.unit)})
        for name, rate in law.rates.items()
        for limit in rate.limits
        for below in (law.terms * (rate.speed < limit)[:, None],)
    ]


def _lines_of_steps(p: Problem) -> list[Candidate]:
    """Row-to-row changes of the strongest sines; every run has a phase, its start is known to a second."""
    rows, dt, since = p.train, p.period_s, since_first(p.t, p.run)
    want = Wanted(span=float(since.max()), least=SLOWEST_LINE_HZ, most=ON_CLOCK)

    def shape(f: Array) -> Array:
        x, y = (2 * np.pi * float(f[0]) * t for t in (p.t, p.t - dt))
        pair = np.column_stack([np.cos(x) - np.cos(y), np.sin(x) - np.sin(y)])
        return np.hstack([np.where((p.run == k)[:, None], pair, 0.0) for k in np.unique(p.run)])

    form: dict[str, Any] = {"steps": (STEP_CELLS / want.span,), "searched": 0, "domain": "time"}
    form |= {"kind": "line", "per_run": True}
    found, size = standing_out(p.fit().residual[rows], since[rows], p.run[rows], want), ("amplitude", p.unit)
    return [
        tried(DISTURBANCE.name, shape, size, at={"frequency": (f, "Hz")}, frequency=f, **form) for f in found
    ]


def _forward(view: View, c: Command) -> Candidate:
    """A feed-forward that the file does not declare, beside the gains that had to stand for it."""
    unit = c.problem.unit
    rate = f"{unit} s/{view.angle_unit}"
    labels = [(f"{name}_beside", unit) for name, unit in c.labels]
    labels += [("rate_feedforward", rate), ("acceleration_feedforward", rate.replace(" s/", " s2/"))]
    labels += [("friction_feedforward", unit)]
    return Candidate(UNKNOWN, "reference", np.hstack([c.follows, c.forward]), tuple(labels))
