"""From the effects that were fitted to what they may be called."""

from __future__ import annotations

import numpy as np

from calibration.finding import Finding, Parameter
from calibration.names.scene import Scene

LINES = ("gear_eccentricity", "gear_mesh", "motor_cogging", "bearing_pass")
# names of a loop after every reversal, and what tells how wide it is
LOOPS: dict[str, tuple[str, ...]] = {"presliding": ("breakaway_travel", "bristle_travel"), "play": ("gap",)}
# of the usual stroke: a wider loop is no bristle's. Contacts slide after micrometres to some hundred of them
# (Al-Bender, Lampaert, Swevers 2005)
WIDEST = 0.05
BRISTLE = {"m": 1e-3, "mm": 1.0}  # position unit -> a stroke that bristles may fill (same paper)


def as_told(findings: list[Finding], scene: Scene) -> list[Finding]:
    """Findings of a balance of forces with the names that the log carries."""
    named = [_turned_gap(_wide_loop(_line(f, scene), scene)) for f in findings]
    return _one_loop(named) if scene.force else named


def of_calibrated(findings: list[Finding], scene: Scene, final: dict[str, float]) -> list[Finding]:
    """Sizes that are parts of the friction were fitted beside the one from before the effect was known, which
    a large effect has bent: told as parts of the `final` one (coefficients by the term's name)."""
    coulomb = max(final.get("coulomb", 0.0), 0.0)
    whole = {"relative_rise_of_coulomb": (scene.declared.get("coulomb", 0.0), coulomb)}
    speed = np.abs(scene.view.speed[scene.view.ok])
    if coulomb > 0 and len(speed):
        after = float(np.mean(coulomb + max(final.get("viscous", 0.0), 0.0) * speed))
        before = float(np.mean(scene.friction[scene.view.ok]))
        whole |= dict.fromkeys(("relative_rise", "relative_change", "relative_per_degree"), (before, after))
    for f in findings:
        for size, (before, after) in whole.items():
            if size in f.parameters and before > 0 and after > 0:
                f.parameters[size] = f.parameters[size].times(before / after)
    return findings


def _line(f: Finding, scene: Scene) -> Finding:
    """A line at an order that no stage has is a bearing only when the gear table is there to say so."""
    if f.name == "bearing_pass" and f.order:
        f.note = f"period {(scene.view.turn or 1.0) / f.order:.5g} {scene.angle_unit}"
        if not scene.view.rig.stages:
            f.name, f.stage = "gear_eccentricity", None
            f.equivalent = list(dict.fromkeys([*f.equivalent, *(n for n in LINES if n != f.name)]))
            f.note += "; no gear table was given, so its stage cannot be named"
    return f


def _wide_loop(f: Finding, scene: Scene) -> Finding:
    """A hysteresis over a good part of the stroke is a loop, but of what is not known: gears have gaps of
    minutes of arc."""
    key = next((k for k in LOOPS.get(f.name, ()) if k in f.parameters), None)
    if key is None:
        return f
    v = scene.view
    stroke = float(np.quantile(np.abs(v.since[v.ok]), 0.95)) or 1.0
    travel = f.parameters[key].value
    small = stroke <= BRISTLE.get(scene.angle_unit, 0.0)
    if travel > WIDEST * stroke and not small:
        f.name, f.equivalent = "unknown", []
        f.note = (
            f"a loop of {travel:.3g} {scene.angle_unit} after every reversal: too wide for bristles or gears"
        )
    return f


def _turned_gap(f: Finding) -> Finding:
    """A gap has a width: below zero only the difference of the sensors was taken the other way round."""
    gap = f.parameters.get("gap")
    if f.name == "play" and f.channel == "K" and gap is not None and gap.value < 0:
        low, high = (None if x is None else -x for x in (gap.high, gap.low))
        f.parameters["gap"] = Parameter(-gap.value, gap.unit, low, high)
        f.note = f"{f.note}; the column is the first sensor less the second".lstrip("; ")
    return f


def _one_loop(findings: list[Finding]) -> list[Finding]:
    """Only the first of several loops is an effect; the others are told as its shape."""
    out: list[Finding] = []
    first: Finding | None = None
    for f in findings:
        if f.domain == "reversal" and (f.name in LOOPS or f.name == "unknown"):
            if first is not None:
                first.note = f"{first.note}; its shape needs a second element ({f.name})".lstrip("; ")
                continue
            first = f
        out.append(f)
    return out
