"""The verdict: found, ambiguous, unknown, nothing or cannot tell; how sure; what the log could not tell."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

from calibration.decide.thresholds import STILL_MISSING, Earned
from calibration.finding import UNKNOWN, Finding
from calibration.names import NAMES

UNNAMED = "unknown: repeat the run: what is fixed to angle, to time or to neither tells where to look"
MOST = 3  # experiments of a class of names that are told: a longer sentence is not read. ASSUMPTION
#: channel of an effect -> the row of the error table it is judged by
ROWS = {"T": "torque", "K": "position", "E": "electrical", "S": "velocity"}
PHASES = (
    "Phases are those of the residual, as a cosine. The residual is the torque that the motors supply against"
    " the effect, or the difference of two encoders. A plant.yaml has the effect's own torque or error, as a"
    " sine."
)
PLACES = "The phase of a damaged tooth is its place on its part, in turns from where the position is zero."


def judge(effects: list[Finding], lacks: Sequence[str] = ()) -> tuple[str, str | None]:
    """Verdict and separating experiment for ranked effects; `lacks`: needed before "nothing" is said."""
    responses = [e for e in effects if not e.of_column]
    if not responses and (lacks or not effects):
        return ("cannot tell", "; ".join(lacks)) if lacks else ("nothing", None)
    names = [n for e in effects if e.equivalent for n in (e.name, *e.equivalent)]
    if responses and all(e.name == UNKNOWN for e in responses):
        return UNKNOWN, UNNAMED
    texts = [f"{n}: {NAMES[n].experiment}" for n in dict.fromkeys(names) if n in NAMES]
    return "ambiguous" if effects[0].equivalent else "found", "; ".join(texts[:MOST]) or None


def kind_of(effect: Finding, place: int, error: Mapping[str, Mapping[str, Any]]) -> str | None:
    """Kind of an answer: by what is left, whether its name is alone, its place; None without a floor."""
    row = error.get(ROWS.get(effect.channel, ""))
    if not row or not row["floor"]:
        return None
    if row["after"] > STILL_MISSING * row["floor"]:
        return "above"
    if set(effect.equivalent) - {effect.name}:
        return "ambiguous"
    return "sole" if place == 0 else "further"


def probability(
    effect: Finding,
    place: int,
    error: Mapping[str, Mapping[str, Any]],
    earned: Mapping[str, Earned] | None,
) -> float | None:
    """How often answers of its kind had the right name on sealed logs; None where none were made."""
    kind = kind_of(effect, place, error)
    known = (earned or {}).get(kind or "")
    return None if known is None else known.probability


def effect_as_dict(
    effect: Finding, place: int, error: Mapping[str, dict[str, Any]], earned: Mapping[str, Earned] | None
) -> dict[str, Any]:
    """One effect as in report.json; `earned` of this kind of drive, without it no probability is told."""
    sure = probability(effect, place, error, earned)
    return {
        "name": effect.name,
        "equivalent": effect.equivalent,
        "stage": effect.stage,
        "harmonic": effect.harmonic,
        "channel": effect.channel,
        "probability": None if sure is None else round(sure, 4),
        "parameters": {k: asdict(p) for k, p in effect.parameters.items()},
        "domain": effect.domain,
        "order": effect.order,
        "frequency_Hz": effect.frequency,
        "evidence": round(effect.evidence, 2),
        "note": effect.note,
    } | ({} if effect.curve is None else {"curve": asdict(effect.curve)})


def conventions(effects: Sequence[Finding]) -> list[str]:
    """Definitions of the phases in the report."""
    units = {e.parameters["phase"].unit for e in effects if "phase" in e.parameters}
    return [PHASES] * bool(units - {"turn"}) + [PLACES] * ("turn" in units)
