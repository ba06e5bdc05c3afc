"""Negative controls of a drive's findings: the effect made wrong on purpose, which must not be accepted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.candidates.candidate import sine_columns
from calibration.decide.controls import controls
from calibration.response.look import Balance
from calibration.statistics.regression import gls

CELLS = 1.5  # resolution cells (1 / travel) by which a line's order is made wrong
MOST = 6  # lines that are tried


def drive_controls(b: Balance) -> list[dict[str, Any]]:
    """Time reversed and sign flipped for every effect, and lines at an order beside their own."""
    s = b.named
    span = b.scene.span or 1.0
    out = controls(s, None, span)
    p = s.problem
    x = b.view.x[b.view.rows]
    for k, chosen in enumerate(s.chosen[:MOST]):
        c = chosen.candidate
        if c.kind != "line" or not c.order or (c.harmonic is None and c.stage is not None):
            continue
        if c.name in ("position_friction", "torque_ripple", "command_disturbance", "gravity_imbalance"):
            continue
        others = [o.candidate.columns for j, o in enumerate(s.chosen) if j != k]
        for shift in (CELLS, -CELLS):
            order = c.fixed["order"][0] if "order" in c.fixed else c.order
            rate = order / (b.view.turn or 1.0) + shift / span
            label = p.session if c.per_run else np.zeros_like(p.session)
            wrong = replace(c, columns=sine_columns(x * rate, label), shape=None)
            fit = gls(p.y, np.hstack([p.base, *others, wrong.columns]), p.train, p.ar_order, p.block)
            out.append(
                {
                    "what": f"order {rate * (b.view.turn or 1.0):.4g} in place of {order:.4g} ({c.say()})",
                    "accepted": bool(fit.loglik >= s.after.loglik * fit.rows / s.after.rows),
                }
            )
    return out
