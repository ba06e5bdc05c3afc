"""From the effects that were fitted to what they may be called."""

import numpy as np

from calibration.finding import UNKNOWN, Finding, Parameter
from calibration.names import NAMES
from calibration.names.bearing_pass import of_no_stage
from calibration.names.friction_warmup import OF_COULOMB
from calibration.names.scene import Scene

# share of the usual stroke: contacts slide after some hundred micrometres (Al-Bender, Lampaert, Swevers 2005)
WIDEST = 0.05
BRISTLE = {"m": 1e-3, "mm": 1.0}  # position unit -> a stroke that bristles may fill (same paper)


def as_told(findings: list[Finding], scene: Scene) -> list[Finding]:
    """Findings of a balance of forces with the names that the log carries."""
    named = [_turned_gap(_wide_loop(of_no_stage(f, scene), scene)) for f in findings]
    return _one_loop(named) if scene.force else named


def of_calibrated(findings: list[Finding], scene: Scene, final: dict[str, float]) -> list[Finding]:
    """Parts of a friction from before the effect was known, told as parts of the `final` one, by its name."""
    for f in findings:  # a slow motion is behind by the delay times the part of the sensor that is late
        if "ratio" in f.parameters and f.name == "channel_delay":
            part = f.parameters.pop("ratio").value / (final.get("scale") or scene.view.response.ratio or 1.0)
            f.parameters["delay"] = f.parameters["delay"].times(abs(part))
    coulomb = max(final.get("coulomb", 0.0), 0.0)
    known = scene.declared.get("coulomb", 0.0)
    speed = np.abs(scene.view.speed[scene.view.ok])
    if coulomb <= 0 or not len(speed):
        return findings
    after = float(np.mean(coulomb + max(final.get("viscous", 0.0), 0.0) * speed))
    before = float(np.mean(scene.sliding.size[scene.view.ok]))
    for f in findings:
        was, now = (known, coulomb) if OF_COULOMB in f.parameters else (before, after)
        for size in NAMES[f.name].relative if f.name in NAMES else ():
            if size in f.parameters and f.parameters[size].unit.startswith("1") and was > 0 and now > 0:
                f.parameters[size] = f.parameters[size].times(was / now)
    return findings


def _loop(f: Finding) -> tuple[str, ...]:
    """Parameters that are the width of a loop after every reversal."""
    return NAMES[f.name].loop if f.name in NAMES else ()


def _wide_loop(f: Finding, scene: Scene) -> Finding:
    """A loop over a good part of the stroke has no name: gears have gaps of minutes of arc."""
    key = next((k for k in _loop(f) if k in f.parameters), None)
    if key is None:
        return f
    travel, stroke = f.parameters[key].value, scene.stroke
    small = stroke <= BRISTLE.get(scene.angle_unit, 0.0)
    if travel > WIDEST * stroke and not small:
        f.name, f.equivalent = UNKNOWN, []
        wide = f"{travel:.3g} {scene.angle_unit}"
        f.note = f"a loop of {wide} after every reversal: too wide for bristles or gears"
    return f


def _turned_gap(f: Finding) -> Finding:
    """A gap has a width: below zero only the difference of the sensors was taken the other way round."""
    gap = f.parameters.get("gap")
    if f.channel == "K" and gap is not None and gap.value < 0:
        low, high = (None if x is None else -x for x in (gap.high, gap.low))
        f.parameters["gap"] = Parameter(-gap.value, gap.unit, low, high)
        f.note = f"{f.note}; the column is the first sensor less the second".lstrip("; ")
    return f


def _one_loop(findings: list[Finding]) -> list[Finding]:
    """Only the first of several loops is an effect; the others are told as its shape."""
    out: list[Finding] = []
    first: Finding | None = None
    for f in findings:
        if f.domain == "reversal" and (_loop(f) or f.name == UNKNOWN):
            if first is not None:
                first.note = f"{first.note}; its shape needs a second element ({f.name})".lstrip("; ")
                continue
            first = f
        out.append(f)
    return out
