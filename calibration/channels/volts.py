"""A rig's electrical balance: volts at the motor against what its winding and its turning ask for.

u = R i + K v + L di/dt. R holds the brushes and the bridge, K is per position unit. Volts are measured, or a
duty times the supply.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from calibration.channels.drivenoise import passed
from calibration.channels.floors import floor_of
from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.inputs.declaration import Response
from calibration.readers.run import Array

# of the volts' rms: smaller is what meters and a duty's rounding are sure to. ASSUMPTION: shunt amplifiers
# and voltage dividers have 0.1 to 1 % of full scale
LEAST = 0.002
LAG = "inductance_with_lag"  # a current that is read T late adds R T to it
FEWEST = 200  # rows that are fitted


@dataclass(frozen=True)
class Volts:
    """The balance as a problem, a view whose response are the volts, the floor, V, and where it is from."""

    problem: Problem
    view: View
    floor: float | None
    floor_from: str


def volts_of(view: View) -> tuple[Array, Array | None] | None:
    """Full-rate volts and duty; None where the log has none."""
    columns, duty = view.columns, view.columns.get("duty")
    if "current" not in columns:
        return None
    if "voltage" in columns:
        return columns["voltage"], None
    if duty is None:
        return None
    supply = columns.get("supply", np.full(len(duty), view.rig.supply_V or 0.0))
    return duty * supply, duty


def volts_balance(view: View, balance: Problem) -> Volts | None:
    """The electrical balance on the rows of another one; None where the log has no volts or no current."""
    found = volts_of(view)
    if found is None:
        return None
    volts, _ = found
    own = replace(view, response=Response("voltage", "V"))
    i, place = view.columns["current"], view.angle_unit
    valid = view.ok[view.rows]
    p = replace(
        balance,
        channel="E",
        unit="V",
        y=view.at(volts),
        base=view.at(np.column_stack([i, view.rate(view.x), view.rate(i)])),
        base_labels=[("resistance", "ohm"), ("torque_constant", f"V s/{place}"), (LAG, "H")],
        valid=valid,
        fresh=None,
        floor=0.0,
        resolved=None,
        sensor="voltage",
    )
    if p.train.sum() < FEWEST:
        return None
    p.step = LEAST * float(np.std(p.y[p.train]))
    beta = np.linalg.lstsq(p.base[p.train], p.y[p.train], rcond=None)[0]
    fitted = {name: float(b) for (name, _), b in zip(p.base_labels, beta, strict=True)}
    noise = _noise(view, volts, i, fitted["resistance"])
    p.floor = noise or 0.0
    return Volts(p, own, *floor_of(own, p, lambda: noise))


def _noise(view: View, volts: Array, current: Array, resistance: float) -> float | None:
    """rms, V, of both columns' noise from row to row and of their steps, behind the filter."""
    width = max(view.sigma, 1.0)
    own, others = passed(view, volts, width), passed(view, current * resistance, width)
    return None if own is None or others is None else float(np.hypot(own, others))
