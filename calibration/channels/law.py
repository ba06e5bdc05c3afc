"""The command of a rig: its effort against the law that its controller is declared to have.

    pid      u = p e + i int(e) + d de/dt          e = reference - position
    cascade  u = velocity (position e - v)

Columns go through the balance's filter, so that law and effort lose the same. The gains are fitted anew,
beside the lateness of the effort's row and of the rate, which a controller takes from positions that have
passed; what the law cannot make of reference and position acts in front of the logged effort.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.channels.problem import Problem
from calibration.channels.view import View, pieces
from calibration.inputs.declaration import Controller
from calibration.readers.run import Array

DELAY = "law_delay"  # nuisances: the effort's row, and the rate that the law uses


def law_problem(view: View, balance: Problem, law: Controller) -> Problem:
    """The command as a regression on the balance's rows; base: the law's terms, an offset, how late the
    effort's row is and how late the rate. A controller's integral begins anew, and with any offset, in every
    file."""
    effort, x = view.columns["effort"], view.x
    error = view.columns["reference"] - x
    labels: list[tuple[str, str]] = []
    unit, place = view.rig.columns["effort"].unit, view.angle_unit
    if law.law == "cascade":
        full = [error, -view.rate(x)]
        labels = [("gain_of_error", f"{unit}/{place}"), ("gain_of_rate", f"{unit} s/{place}")]
        declared = law.gains["velocity"] * (law.gains["position"] * full[0] + full[1])
    else:
        terms = {"p": error, "i": _integral(view, error), "d": view.rate(error)}
        per = {"p": f"{unit}/{place}", "i": f"{unit}/({place} s)", "d": f"{unit} s/{place}"}
        full = [terms[k] for k in law.gains]
        labels = [(f"gain_{k}", per[k]) for k in law.gains]
        declared = sum((law.gains[k] * terms[k] for k in law.gains), np.zeros(len(x)))
    rates = [view.second(x)] if law.law == "cascade" else [-view.second(error)] if "d" in law.gains else []
    base = view.at(np.column_stack([*full, np.ones(len(x)), -view.rate(declared), *rates]))
    labels += [("law_offset", unit), (DELAY, "s"), *[(DELAY, f"{unit} s2/{place}") for _ in rates]]
    offsets = np.column_stack([(balance.session == k).astype(float) for k in np.unique(balance.session)])
    p = replace(
        balance,
        channel="S",
        unit=unit,
        y=view.at(effort),
        base=base,
        base_labels=labels,
        valid=view.ok[view.rows],
        fresh=offsets,
        floor=0.0,
        step=0.0,
        resolved=None,
        sensor="command",
    )
    if "i" in law.gains and offsets.shape[1] > 1:
        first = int(np.searchsorted(np.unique(p.session), p.session[p.train][0])) if p.train.any() else 0
        others = np.delete(offsets, first, axis=1)
        p.base = np.hstack([p.base, others])
        p.base_labels = [*labels, *[("law_offset", unit)] * others.shape[1]]
    return p


def _integral(view: View, error: Array) -> Array:
    out = np.zeros(len(error))
    for a, b in pieces(view.segment):
        out[a:b] = np.cumsum(error[a:b]) * view.period_s
    return out


def declared_terms(law: Controller) -> dict[str, float]:
    """The declared size of every term of the law, by its label in the base."""
    if law.law == "cascade":
        velocity = law.gains["velocity"]
        return {"gain_of_error": velocity * law.gains["position"], "gain_of_rate": velocity}
    return {f"gain_{k}": v for k, v in law.gains.items()}
