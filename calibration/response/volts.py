"""A rig's electrical balance: its names, and the motor's numbers."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.channels.volts import Volts, volts_balance
from calibration.decide.select import Selection, select
from calibration.finding import Finding
from calibration.names import NAMES
from calibration.names.name import VOLTS
from calibration.names.scene import Scene
from calibration.names.sines import over_place
from calibration.response.harmonics import findings_of
from calibration.response.left import Left, left_over, settle
from calibration.response.prune import prune, signed
from calibration.response.unnamed import beyond_names

# of u0, that a knee may be at, and of a period: switches' resistances bend a dead band's corner. ASSUMPTION
REACH, SHARP = 2.0, 0.005
BRUSH_HARMONICS = 6  # of the motor's turn, as for the axis


@dataclass
class Electric:
    """`named` without unnamed functions: what the motor's numbers are read from."""

    balance: Volts
    selection: Selection
    named: Selection
    findings: list[Finding]
    left: Left | None = None
    lacks: list[str] = field(default_factory=list)
    notes: list[str] = field(default_factory=list)


def look_at_volts(view: View, balance: Problem, seed: int) -> Electric | None:
    """None where the log has no volts or no current."""
    b = volts_balance(view, balance)
    if b is None:
        return None
    p, rows = b.problem, b.problem.train
    beta = np.linalg.lstsq(p.base[rows], p.y[rows], rcond=None)[0]
    declared = {n: float(x) for (n, _), x in zip(p.base_labels, beta, strict=True)}
    scene = Scene(b.view, p, declared, p.y - p.base @ beta, np.zeros((len(p.y), 0)))
    names = [n for n in NAMES.values() if VOLTS in n.channels]
    offered = [c for n in names for c in n.columns(scene)] + _brushes(scene)
    s = prune(signed(select(p, offered, np.random.default_rng(seed))))
    s, together, unnamed = beyond_names(s, scene, seed)
    found = [f for k in range(len(s.chosen)) for f in findings_of(s, k)]
    final = {n: float(x) for (n, _), x in zip(p.base_labels, s.after.beta, strict=False)}
    cold = final["resistance"] / declared["resistance"] if declared["resistance"] else 1.0
    for f in found:
        if f.name == "winding_heating":  # the warm resistance makes the heat, the cold one is what rises
            f.parameters["thermal_resistance"] = f.parameters["thermal_resistance"].times(1 / cold)
        if f.name == "magnet_weakening" and final["torque_constant"]:  # of the constant before it fell
            whole = declared["torque_constant"] / final["torque_constant"]
            f.parameters["fraction"] = f.parameters["fraction"].times(max(whole, 1e-9))
    sure = max(b.floor, p.step) if b.floor else None  # less than meters are sure to is not "still missing"
    found = settle([_dead(f) for f in found] + unnamed, left_over(s, scene, sure), "E")
    lacks = [f"{n.name}: {n.lacks(scene)}" for n in names if n.lacks(scene)]
    left = left_over(together, scene, sure)
    return Electric(
        b, together, s, found, left, lacks, [f"floor of the volts: {b.floor_from}", *_signs(declared)]
    )


def _dead(f: Finding) -> Finding:
    """A bridge that loses u0 of every pulse loses shorter pulses whole, and no longer ones in part; one whose
    loss grows over far longer pulses is something else over the command."""
    if f.name != "pwm_deadband" or f.parameters["knee"].value < REACH * f.parameters["u0"].value + SHARP:
        return f
    note = "volts are lost in proportion to the duty up to the knee: no dead band does so"
    return replace(f, name="unknown", note=note)


def _signs(declared: dict[str, float]) -> list[str]:
    """What a negative number says of the columns."""
    return [
        f"{name} comes out as {declared[name]:.3g}: {why} counts the other way"
        for name, why in (("resistance", "the current"), ("torque_constant", "the position"))
        if declared[name] < 0
    ]


def _brushes(s: Scene) -> list[Candidate]:
    """A resistance over the motor's angle: brushes and commutator. It has no name in the catalogue."""
    out = []
    for stage in s.view.rig.stages:
        if stage.period is None or stage.kind not in ("motor_cogging", "torque_ripple"):
            continue
        for h in range(1, BRUSH_HARMONICS + 1):
            blank = Candidate(
                "unknown",
                "motor_angle",
                np.zeros((len(s.problem.y), 0)),
                (("amplitude", "ohm"),),
                kind="line",
                stage=stage.name,
                harmonic=h,
                order=h / stage.period * (s.view.turn or 1.0),
            )
            out += over_place(s, blank, h / stage.period, s.view.columns["current"])
    return out
