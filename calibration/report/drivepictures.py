"""Pictures of a drive's report."""

from __future__ import annotations

import numpy as np

from calibration.decide.select import Selection
from calibration.readers.run import Array
from calibration.report import plots as draw
from calibration.response.look import Balance, DriveResult

MOST = 4  # pictures of effects in a balance


def pictures(found: DriveResult, gate_text: str) -> list[dict[str, str]]:
    """Every balance: its effects over their domains, the spectrum, the held-out residual, the gate."""
    out = []
    for b in found.balances:
        s = b.selection
        for k in _worth_drawing(s):
            c = s.chosen[k].candidate
            x, label = _domain(b, c.domain, c.repeats, c.frequency)
            odd = b.view.direction[b.view.rows] if c.name == "position_friction" else None
            out.append(
                {
                    "image": draw.domain_plot(s, x, label, _title(b, k), k, odd),
                    "alt": "Fitted rows, the declared model and the other effects taken away",
                }
            )
        turns = b.view.x[b.view.rows]
        stages = {g.name: 1 / g.period for g in b.view.rig.stages if g.period}
        unit = b.view.angle_unit
        one = unit.removesuffix("s") if unit.endswith("turns") else unit
        out.append(
            {
                "image": draw.order_plot(s, turns, stages, "Amplitude over order", f"cycles per {one}"),
                "alt": "Fitted rows; dotted: stages of the rig file, short marks: orders that were found",
            }
        )
        out.append(
            {
                "image": draw.trace_plot(s, "Held-out residual before and after"),
                "alt": "Rows nothing was fitted to",
            }
        )
        out.append({"image": draw.gate_plot(s, "Is anything there at all?"), "alt": gate_text})
    if found.law is not None:
        title = "Held-out command less its declared law, before and after"
        alt = "Rows nothing was fitted to; the law's gains are those of the fitted rows"
        out.append({"image": draw.trace_plot(found.law.selection, title), "alt": alt})
    if found.electric is not None:
        title = "Held-out volts less winding and back-EMF, before and after"
        alt = "Rows nothing was fitted to"
        out.append({"image": draw.trace_plot(found.electric.selection, title), "alt": alt})
    return out


def _worth_drawing(s: Selection) -> list[int]:
    """One picture per name, the strongest first; an unnamed function is always drawn."""
    names = [x.candidate.name for x in s.chosen]
    first = [k for k, name in enumerate(names) if name not in names[:k]]
    more = [k for k in range(len(names)) if k not in first]
    return sorted([*first, *more[: max(MOST - len(first), 0)]])


def _title(b: Balance, k: int) -> str:
    x = b.selection.chosen[k]
    alike = [e.candidate.name for e in b.selection.classes[k] if e.candidate.name != x.candidate.name]
    more = f" (or {', '.join(dict.fromkeys(alike[:2]))})" if alike else ""
    return x.candidate.say() + more


def _domain(b: Balance, name: str, order: float | None, frequency: float | None) -> tuple[Array, str]:
    v = b.view
    at = v.rows
    if order is not None:
        return (v.x[at] / (v.turn or 1.0) * order) % 1.0, f"phase of order {order:.5g}, turns"
    if frequency is not None:
        return (v.t[at] * frequency) % 1.0, f"phase of {frequency:.5g} Hz, turns"
    table = {
        "axis_angle": (v.x[at], f"position, {v.angle_unit}"),
        "velocity": (v.speed[at], f"speed, {v.angle_unit}/s"),
        "reversal": (v.since[at], f"travel since reversal, {v.angle_unit}"),
        "time": (v.clock[at], "time, s"),
    }
    if name == "temperature" and "temperature" in v.columns:
        return v.columns["temperature"][at], "temperature, degC"
    x, label = table.get(name, (v.clock[at], "time, s"))
    return np.asarray(x), label
