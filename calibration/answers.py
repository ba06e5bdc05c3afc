"""From the pipelines' results to a verdict with its error table, controls and pictures."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.channels.slowoffset import SLOW
from calibration.decide.parameters import interval
from calibration.decide.select import CLOSEST, Selection
from calibration.decide.verdict import Verdict
from calibration.finding import Parameter
from calibration.readers.run import Array

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


def calibrated(s: Selection, skip: tuple[str, ...] = (), model: float | None = None) -> dict[str, Parameter]:
    """The declared model's parameters with intervals; `model`: the model's own error, of a value, where it is
    known to be another one than `interval` takes."""
    out = {}
    blocks = max(int(s.problem.train.sum() / s.problem.block), 5)
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name in (*skip, SLOW) or name in out:
            continue
        value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
        low, high = interval(value, error, blocks, None if model is None else model * value)
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
