"""Names that fitted effects may bear, and which of them they keep once everything has been tried."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from calibration.decide.energy import negative
from calibration.decide.selection import Selection
from calibration.decide.thresholds import LUCK_Z
from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.names import NAMES
from calibration.names.bearing_pass import of_a_guess, of_no_stage
from calibration.names.brake_drag import one_way
from calibration.names.friction_warmup import OF_COULOMB
from calibration.names.gravity_imbalance import once_a_turn
from calibration.names.scene import Scene
from calibration.names.structural_mode import another_body

# share of the usual stroke: contacts slide after some hundred micrometres (Al-Bender, Lampaert, Swevers 2005)
WIDEST = 0.05
BRISTLE = {"m": 1e-3, "mm": 1.0}  # position unit -> a stroke that bristles may fill (same paper)
#: (channel, what, why) as in the report's `refused`
Refused = tuple[str, str, str]
Against = Callable[[Finding], str]
"""Why a finding does not keep its name; empty when it does."""


def withdraw(findings: Sequence[Finding], *against: Against) -> tuple[list[Finding], list[Refused]]:
    """Findings that keep their name, and a refusal for each that does not."""
    said = [(f, next(filter(None, (says(f) for says in against)), "")) for f in findings]
    refused = [
        (f.channel, f"{f.name} on {f.stage}" if f.stage else f.name, f"withdrawn: {why}")
        for f, why in said
        if why
    ]
    return [f for f, why in said if not why], refused


def accepted(f: Finding, controls: Sequence[Mapping[str, Any]]) -> list[str]:
    """Accepted controls of the finding's name and place, or of its order: a line may have been renamed."""
    line = f"in place of {f.order:.4g} (" if f.order else None
    return [
        c["what"].split(" (")[0]
        for c in controls
        if c["accepted"]
        and ((c["name"], c["stage"], c["harmonic"]) == f.key or bool(line and line in c["what"]))
    ]


def failed_controls(controls: Sequence[Mapping[str, Any]]) -> Against:
    """What is wrong on purpose must not fit as well."""

    def says(f: Finding) -> str:
        wrong = accepted(f, controls)
        return f"accepted as well with {', '.join(wrong)}" if wrong else ""

    return says


def against_nature(selections: Mapping[str, Selection]) -> Against:
    """A fit with a negative mass, friction, resistance or torque constant names nothing in its channel."""
    wrong = {channel: negative(s, LUCK_Z) for channel, s in selections.items()}

    def says(f: Finding) -> str:
        name = wrong.get(f.channel)
        if not name:
            return ""
        s, p = selections[f.channel], selections[f.channel].problem
        return f"beside it {name} would be {p.named(s.after)[name].value:.3g} {dict(p.base_labels)[name]}"

    return says


def unnamed(findings: list[Finding], controls: Sequence[Mapping[str, Any]]) -> list[Finding]:
    """The findings of a rig's balance; what loses its name stays as `unknown`."""
    out = []
    for f in findings:
        wrong = accepted(f, controls)
        if wrong and f.name != UNKNOWN:
            note = f"{wrong[0]} fits as well: the name {f.name} is withdrawn. {f.note}".strip()
            f = replace(f, name=UNKNOWN, stage=None, harmonic=None, equivalent=[], note=note)
        out.append(f)
    return out


def as_told(findings: list[Finding], scene: Scene) -> list[Finding]:
    """Findings of a balance of forces with the names that the log carries."""
    named = findings
    for told in (of_no_stage, of_a_guess, once_a_turn, one_way, another_body, _wide_loop):
        named = [told(f, scene) for f in named]
    named = [_turned_gap(f) for f in named]
    return _one_loop(named) if scene.force else named


def of_calibrated(findings: list[Finding], scene: Scene, final: dict[str, float]) -> list[Finding]:
    """Parts of a friction from before the effect was known, told as parts of the `final` one, by its name."""
    whole = final.get("scale") or scene.view.response.ratio or 1.0
    findings = [_of_all(f, whole) for f in findings]
    coulomb = max(final.get("coulomb", 0.0), 0.0)
    known = scene.declared.get("coulomb", 0.0)
    speed = np.abs(scene.view.speed[scene.view.ok])
    if coulomb <= 0 or not len(speed):
        return findings
    after = float(np.mean(coulomb + max(final.get("viscous", 0.0), 0.0) * speed))
    before = float(np.mean(scene.sliding.size[scene.view.ok]))
    out = []
    for f in findings:
        was, now = (known, coulomb) if OF_COULOMB in f.parameters else (before, after)
        parts = NAMES[f.name].relative if was > 0 else ()
        sizes = {size: f.parameters[size] for size in parts if size in f.parameters}
        out.append(f.having(**{k: p.times(was / now) for k, p in sizes.items() if p.unit.startswith("1")}))
    return out


def _of_all(f: Finding, whole: float) -> Finding:
    """A slow motion is behind by the delay times the part of the sensor that is late, of `whole`."""
    if "ratio" not in f.parameters or f.name != "channel_delay":
        return f
    kept = {k: p for k, p in f.parameters.items() if k != "ratio"}
    part = abs(f.parameters["ratio"].value / whole)
    return replace(f, parameters=kept | {"delay": kept["delay"].times(part)})


def _wide_loop(f: Finding, scene: Scene) -> Finding:
    """A loop over a good part of the stroke has no name: gears have gaps of minutes of arc."""
    key = next((k for k in NAMES[f.name].loop if k in f.parameters), None)
    if key is None:
        return f
    travel, stroke = f.parameters[key].value, scene.stroke
    small = stroke <= BRISTLE.get(scene.angle_unit, 0.0)
    if travel <= WIDEST * stroke or small:
        return f
    note = f"a loop of {travel:.3g} {scene.angle_unit} after every reversal: too wide for bristles or gears"
    return replace(f, name=UNKNOWN, equivalent=[], note=note)


def _turned_gap(f: Finding) -> Finding:
    """A gap has a width: below zero only the difference of the sensors was taken the other way round."""
    gap = f.parameters.get("gap")
    if f.channel != "K" or gap is None or gap.value >= 0:
        return f
    low, high = (None if x is None else -x for x in (gap.high, gap.low))
    turned = Parameter(-gap.value, gap.unit, low, high)
    return f.having(gap=turned).noted("the column is the first sensor less the second")


def _one_loop(findings: list[Finding]) -> list[Finding]:
    """Only the first of several loops is an effect; the others are told as its shape."""
    out: list[Finding] = []
    first: int | None = None
    for f in findings:
        if f.domain == "reversal" and (NAMES[f.name].loop or f.name == UNKNOWN):
            if first is not None:
                out[first] = out[first].noted(f"its shape needs a second element ({f.name})")
                continue
            first = len(out)
        out.append(f)
    return out
