"""The verdict: found, ambiguous, unknown, nothing or cannot tell; how sure; what the log could not tell."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from typing import Any

from calibration.decide.experiments import experiment
from calibration.decide.probability import probability
from calibration.decide.thresholds import Earned
from calibration.finding import Finding, Parameter

PHASES = (
    "Phases here are those of the residual as a cosine: of the torque that the motors supply against the "
    "effect, or of the difference of two encoders; plant.yaml, where one is written, has the effect's own"
    " torque or error, a sine."
)
PLACES = "The phase of a damaged tooth is its place on its part, in turns from where the position is zero."


@dataclass
class Verdict:
    """The answer, channel-independent; `error` and `controls` as in report.json."""

    verdict: str
    effects: list[Finding]
    error: dict[str, dict[str, Any]] = field(default_factory=dict)
    held_out: list[str] = field(default_factory=list)
    calibrated: dict[str, Parameter] = field(default_factory=dict)
    not_identifiable: list[str] = field(default_factory=list)
    controls: list[dict[str, Any]] = field(default_factory=list)
    separating: str | None = None
    reasons: list[str] = field(default_factory=list)
    remarks: list[str] = field(default_factory=list)  # of the reasons, what the terminal repeats
    thresholds: dict[str, dict[str, float]] = field(default_factory=dict)
    refused: list[tuple[str, str, str]] = field(default_factory=list)
    closed_loop: dict[str, dict[str, Any]] = field(default_factory=dict)
    earned: Mapping[str, Earned] | None = None  # of this kind of drive; without it no probability is told


def judge(effects: list[Finding], lacks: Sequence[str] = ()) -> tuple[str, str | None]:
    """Verdict and separating experiment for ranked effects; `lacks` says what the log would need before
    "nothing" could be said of it."""
    if not effects:
        return ("cannot tell", "; ".join(lacks)) if lacks else ("nothing", None)
    names = [n for e in effects if e.equivalent for n in (e.name, *e.equivalent)]
    if any(e.name != "unknown" for e in effects):
        verdict = "ambiguous" if effects[0].equivalent else "found"
    else:
        verdict, names = "unknown", ["unknown"]
    return verdict, experiment(names)


def effect_as_dict(effect: Finding, sure: float | None) -> dict[str, Any]:
    """One effect as in report.json, `sure` its probability."""
    return {
        "name": effect.name,
        "equivalent": effect.equivalent,
        "stage": effect.stage,
        "harmonic": effect.harmonic,
        "channel": effect.channel,
        "probability": None if sure is None else round(sure, 4),
        "parameters": {k: p.as_dict() for k, p in effect.parameters.items()},
        "domain": effect.domain,
        "order": effect.order,
        "frequency_Hz": effect.frequency,
        "evidence": round(effect.evidence, 2),
        "note": effect.note,
    } | ({} if effect.curve is None else {"curve": asdict(effect.curve)})


def as_dict(v: Verdict) -> dict[str, Any]:
    """report.json, with a few fields beside the contract's."""
    return {
        "verdict": v.verdict,
        "effects": [effect_as_dict(e, probability(e, k, v.error, v.earned)) for k, e in enumerate(v.effects)],
        "error": v.error,
        **({"closed_loop": v.closed_loop} if v.closed_loop else {}),
        "held_out": v.held_out,
        "calibrated": {k: p.as_dict() for k, p in v.calibrated.items()},
        "not_identifiable": v.not_identifiable,
        "separating_experiment": v.separating,
        "controls": v.controls,
        "thresholds": v.thresholds,
        "reasons": v.reasons,
        "conventions": _conventions(v.effects),
        "refused": [{"channel": c, "what": w, "why": y} for c, w, y in v.refused],
    }


def _conventions(effects: Sequence[Finding]) -> list[str]:
    """What the phases that are told are phases of."""
    units = {e.parameters["phase"].unit for e in effects if "phase" in e.parameters}
    return [PHASES] * bool(units - {"turn"}) + [PLACES] * ("turn" in units)
