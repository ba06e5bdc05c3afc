"""Score one answer about another drive against its truth."""

import json
from typing import Any

from tests.blind.score import held_out, worse

BAD_ROWS = {"spikes": {"log_wrap", "sample_loss"}, "gaps": {"sample_loss"}}
"""Names that tell what was done to the rows of a log: no effect of the drive, and right."""
SURE = 0.9
SIZES = ("amplitude", "torque", "gap", "compliance", "stiffness", "delay", "error")
"""Parameters of the report that are an effect's size; zero is no effect."""


def said(effect: dict[str, Any]) -> set[str]:
    """The name and those the answer does not tell from it."""
    return {effect["name"], *effect.get("equivalent", [])}


def fits(effect: dict[str, Any], truth: dict[str, Any]) -> bool:
    """Whether a stated effect is the hidden one: its name, or a class that holds it and only its like.

    What the truth calls confounded, this log cannot tell from it: a class may hold that, no lone name be it.
    """
    allowed = set(truth["class"])
    beside = allowed | {"unknown", *truth.get("confounded", [])}
    return (
        effect["name"] == truth["name"]
        or (truth["name"] in said(effect) and said(effect) <= beside)
        or (effect["name"] in allowed)
    )


def holds_zero(effect: dict[str, Any]) -> bool:
    """Whether a named effect's size has an interval that zero is in."""
    sizes = (v for k, v in effect.get("parameters", {}).items() if k in SIZES)
    return any(v.get("low") is not None and v["low"] <= 0.0 <= v["high"] for v in sizes)


def short(report: dict[str, Any], top: dict[str, Any] | None, wanted: dict[str, Any]) -> bool:
    """A log too short to be sure: the name, or `cannot tell` that tells of the candidate or its stage."""
    if top is not None:
        return fits(top, wanted)
    told = json.dumps([report.get("separating_experiment"), report.get("refused")])
    candidates = [*wanted["class"], *([wanted["stage"]] if wanted.get("stage") else [])]
    return report["verdict"] == "cannot tell" and any(name in told for name in candidates)


def score(answer: dict[str, Any], report: dict[str, Any] | None, truth: dict[str, Any]) -> dict[str, Any]:
    """One row of results."""
    harmless = BAD_ROWS.get(truth["spoil"], set())
    effects = [e for e in report["effects"] if e["name"] not in harmless] if report else []
    wanted = truth["effects"][0] if truth["effects"] else None
    inside = bool(wanted and wanted["in_catalogue"])
    wrong = [e for e in effects if e["name"] != "unknown" and not (wanted and fits(e, wanted))]
    row: dict[str, Any] = {
        "key": truth["key"], "cell": truth["cell"], "family": truth["family"], "kind": truth["kind"],
        "truth": wanted["name"] if wanted else "", "ratio": wanted["ratio"] if wanted else 0.0,
        "reached": wanted["reached"] if wanted else 0.0,
        "answered": report is not None, "failure": answer["failure"], "seconds": answer["seconds"],
        "verdict": report["verdict"] if report else None, "said": [sorted(said(e)) for e in effects],
        "probability": [e.get("probability") for e in effects],
        "wrong": len(wrong),
        "sure_and_wrong": sum((e.get("probability") or 0.0) > SURE for e in wrong),
    }  # fmt: skip
    top = effects[0] if effects else None
    staged = bool(wanted and wanted.get("stage"))
    stage = str(top.get("stage") or "").split(" ")[0] if top else ""  # "worm of a 180-tooth wheel" is a worm
    row["stage_right"] = bool(wanted and stage == wanted.get("stage")) if staged else None
    row["empty"] = sum(map(holds_zero, effects))
    if truth["cell"] == "nothing":
        row["right"] = report is not None and not effects
    elif truth["cell"] == "short":
        row["right"] = bool(wanted and report and short(report, top, wanted))
    elif inside:
        row["right"] = bool(top and wanted and fits(top, wanted))
    else:
        row["right"] = bool(
            top
            and wanted
            and ((top["name"] == "unknown" and top.get("domain") in wanted["domain"]) or fits(top, wanted))
        )
    if report is not None:
        row["held_out"] = held_out(report, wanted["channel"] if wanted else None)
        row["worse"] = worse(report)
    return row
