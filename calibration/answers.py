"""From the pipelines' results to a verdict with its error table, controls and pictures."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from calibration.decide.controls import controls
from calibration.decide.finding import Parameter
from calibration.decide.parameters import interval
from calibration.decide.select import CLOSEST, Selection
from calibration.decide.verdict import Verdict, judge
from calibration.readers.rig import Rig
from calibration.readers.run import Array, Run

Answer = tuple[Verdict, list[dict[str, str]], str]


def error_row(s: Selection, floor: float | None) -> dict[str, Any]:
    """One row of the error table; `floor` is measured apart from the fit, None where it is not known."""
    known = floor if floor is not None and np.isfinite(floor) and floor > 0 else None
    return {"unit": s.problem.unit, "before": s.held.before, "after": s.held.after, "floor": known}


def errors(name: str, s: Selection, floor: float | None = None) -> dict[str, dict[str, Any]]:
    """The error table of one channel; empty when there are no held-out rows to measure it on."""
    return {name: error_row(s, floor)} if np.isfinite(s.held.before) else {}


def lacking(s: Selection, channel: str) -> list[str]:
    """What a channel would need before "nothing" could be said of it, and which candidate was close; empty
    when it has enough."""
    short = too_short(s, channel)
    close = [f"{r.what} was {r.why.split(', but')[0]}" for r in s.refused if r.why.startswith(CLOSEST)]
    return [", ".join([*short, *close])] if short else []


def too_short(s: Selection, channel: str) -> list[str]:
    """The reason when a channel holds too little to name anything."""
    return [f"{channel}{r.why}" for r in s.refused if r.what == "every candidate"]


def calibrated(s: Selection, skip: tuple[str, ...] = ()) -> dict[str, Parameter]:
    """The declared model's parameters with intervals."""
    out = {}
    blocks = max(int(s.problem.train.sum() / s.problem.block), 5)
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name in skip or name in out:
            continue
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        low, high = interval(value, error, blocks)
        out[name] = Parameter(value, unit, low, high)
    return out


def gate_rows(selections: dict[str, Selection]) -> dict[str, dict[str, float]]:
    """Threshold and statistic of every channel."""
    return {
        k: {"threshold": s.scores.threshold, "statistic": min(s.statistic, 1e6)}
        for k, s in selections.items()
    }


def refusals(selections: dict[str, Selection]) -> list[tuple[str, str, str]]:
    """Everything that was looked at and refused."""
    seen: dict[tuple[str, str], str] = {}
    for k, s in selections.items():
        for r in s.refused:
            seen.setdefault((k, r.what), r.why)
    return [(k, w, y) for (k, w), y in seen.items()]


GATE = "The largest score of all candidates, in this log and in copies of its residual that hold nothing"


def bench(runs: list[Run], rig: Rig, hold_out: list[str], plots: bool) -> Answer:
    """Answer for another drive's file with a rig file."""
    from calibration.bench import analyse_bench
    from calibration.report import plots as draw

    found = analyse_bench(runs, rig, hold_out)
    s, c = found.selection, found.context
    verdict, separating = judge(found.findings)
    turns = c.angle
    v = Verdict(
        verdict,
        found.findings,
        errors("torque", s, found.problem.floor),
        found.held_out,
        calibrated(s),
        found.not_identifiable,
        controls(s, None, float(np.ptp(turns))) + _stage_controls(found),
        separating,
        too_short(s, "") + ([] if np.any(c.direction) else ["the position does not move"]),
        gate_rows({"T": s}),
        refusals({"T": s}),
    )
    pictures = []
    if plots:
        for k in _worth_drawing(s):
            chosen = s.chosen[k]
            x, label = _domain(
                chosen.candidate.domain,
                c,
                chosen.candidate.order if chosen.candidate.kind == "line" else None,
            )
            odd = c.direction if chosen.candidate.name == "position_friction" else None
            pictures.append(
                {
                    "image": draw.domain_plot(s, x, label, _say(found, k), k, odd),
                    "alt": "Fitted rows, the declared model and the other effects taken away",
                }
            )
        pictures.append(
            {
                "image": draw.order_plot(
                    s, turns, c.stages, "Amplitude over order", f"cycles per {_one(c.angle_unit)}"
                ),
                "alt": "Fitted rows; dotted: stages of the rig file, short marks: orders that were found",
            }
        )
        pictures.append(
            {
                "image": draw.trace_plot(s, "Held-out residual before and after"),
                "alt": "Rows nothing was fitted to",
            }
        )
        pictures.append({"image": draw.gate_plot(s, "Is anything there at all?"), "alt": GATE})
    return v, pictures, rig.name


def _worth_drawing(s: Selection, most: int = 4) -> list[int]:
    """One picture per name, the strongest first; an unnamed function is always drawn."""
    names = [x.candidate.name for x in s.chosen]
    first = [k for k, name in enumerate(names) if name not in names[:k]]
    more = [k for k in range(len(names)) if k not in first]
    return sorted([*first, *more[: max(most - len(first), 0)]])


def _one(unit: str) -> str:
    """Singular of a plural unit: cycles per motor turn."""
    return unit.removesuffix("s") if unit.endswith("turns") else unit


def _say(found: Any, k: int) -> str:
    """Title of an effect's picture: the finding's name, not the candidate's."""
    f = found.findings[k]
    place = f" on {f.stage}" if f.stage else ""
    harmonic = f", harmonic {f.harmonic}" if f.harmonic else ""
    alike = f" (or {', '.join(f.equivalent[:2])}{' …' if len(f.equivalent) > 2 else ''})"
    return f"{f.name}{place}{harmonic}{alike if f.equivalent else ''}"


def _stage_controls(found: Any) -> list[dict[str, Any]]:
    """Lines of the gear table at an order that is off by a resolution cell and a half."""
    from dataclasses import replace

    from calibration.candidates.candidate import sine_columns
    from calibration.decide.controls import _better

    out = []
    s, c = found.selection, found.context
    span = float(np.ptp(c.angle)) or 1.0
    for k, chosen in enumerate(s.chosen[:6]):
        x = chosen.candidate
        if x.kind == "line" and x.order and x.name != "position_friction":
            for shift in (1.5, -1.5):
                order = x.order + shift / span
                wrong = replace(x, columns=sine_columns(c.angle * order, c.session), shape=None)
                out.append(
                    {
                        "what": f"order {order:.4g} in place of {x.order:.4g}",
                        "accepted": _better(s, k, wrong),
                    }
                )
    return out


def _domain(name: str, c: Any, order: float | None) -> tuple[Array, str]:
    if order is not None:
        return (c.angle / c.turn * order) % 1.0, f"phase of order {order:.5g}, turns"
    table = {
        "axis_angle": (c.angle, f"position, {c.angle_unit}"),
        "motor_angle": (c.angle, f"position, {c.angle_unit}"),
        "velocity": (c.speed, f"speed, {c.angle_unit}/s"),
        "reversal": (c.since, f"travel since reversal, {c.angle_unit}"),
        "time": (c.t, "time, s"),
    }
    if name == "temperature" and c.temperature is not None:
        return c.temperature, "temperature, degC"
    if name == "current" and c.load is not None:
        return c.load, f"load, {c.unit}"
    return table.get(name, (c.t, "time, s"))


def axis(
    runs: list[Run],
    hold_out: list[str],
    out: Path,
    plant: Path | None,
    plots: bool,
    tell: Callable[[str], None],
    replay: bool = True,
) -> Answer:
    """Answer for logs of one axis of the telescope."""
    from calibration.axisanswer import axis_answer

    return axis_answer(runs, hold_out, out, plant, plots, tell, replay)
