"""Negative controls: the accepted effect made wrong on purpose, which must not be accepted."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.decide.heldout import predict_residual
from calibration.decide.judge import design
from calibration.decide.select import Selection
from calibration.decide.thresholds import FLIPPED_BY_LUCK
from calibration.readers.run import Array
from calibration.statistics.regression import under

TEETH = {
    "shaft1": (113, 123),
    "shaft2": (123, 17),
    "motor": (27, 27),
    "mesh1": (27, 27),
    "mesh2": (21, 21),
    "mesh3": (250, 250),
    "roller": (30, 30),
}


def controls(selection: Selection, angle_turns: Array | None, span_turns: float) -> list[dict[str, Any]]:
    """One tooth more and less, sign flipped and time reversed, for every chosen effect."""
    out = []
    for k, chosen in enumerate(selection.chosen):
        c = chosen.candidate
        place = {"name": c.name, "stage": c.stage, "harmonic": c.harmonic}
        tests: list[tuple[str, Candidate]] = [
            ("time reversed", replace(c, columns=c.columns[::-1].copy(), shape=None))
        ]
        if c.stage in TEETH and c.kind == "line" and c.order and angle_turns is not None:
            teeth = TEETH[c.stage][0]
            for step, word in ((1, "more"), (-1, "less")):
                order = c.order * (teeth + step) / teeth
                if abs(order - c.order) * span_turns < 0.7:
                    out.append(
                        {
                            "what": f"one tooth {word} on {c.stage}",
                            "accepted": False,
                            "note": "this travel cannot tell one tooth from the next",
                            **place,
                        }
                    )
                    continue
                x = 2 * np.pi * angle_turns * order
                tests.append(
                    (
                        f"one tooth {word} on {c.stage}",
                        replace(c, columns=np.column_stack([np.cos(x), np.sin(x)]), shape=None),
                    )
                )
        for what, wrong in tests:
            row = {"what": f"{what} ({c.say()})", "accepted": _better(selection, k, wrong), **place}
            if what == "time reversed" and _alike(c.columns, wrong.columns):
                row = {
                    "what": row["what"],
                    "accepted": False,
                    "note": "no test here: this motion reads the same backwards",
                    **place,
                }
            out.append(row)
        out.append({"what": f"sign flipped ({c.say()})", "accepted": _flipped(selection, k), **place})
    return out


def _alike(a: Array, b: Array) -> bool:
    """True when b's columns lie mostly in the span of a's: the control is then the effect itself."""
    q, _ = np.linalg.qr(a)
    return bool(np.sum((q.T @ b) ** 2) > 0.4 * np.sum(b**2))


def _better(selection: Selection, k: int, wrong: Candidate) -> bool:
    """True when the wrong candidate in the place of the right one fits at least as well on training rows,
    through the same filter."""
    p = selection.problem
    right = [x.candidate for x in selection.chosen]
    other = [wrong if j == k else c for j, c in enumerate(right)]
    true, false = (under(p.y, design(p, x), p.train, selection.after.whitener) for x in (right, other))
    return false >= true


def _flipped(selection: Selection, k: int) -> bool:
    """True when the effect with its sign turned leaves less on held-out rows than no effect."""
    p = selection.problem
    if p.test.sum() < 20:
        return False
    at = p.base.shape[1] + sum(c.candidate.width for c in selection.chosen[:k])
    x = design(p, [c.candidate for c in selection.chosen])
    beta = selection.after.beta.copy()
    width = selection.chosen[k].candidate.width
    without = beta.copy()
    without[at : at + width] = 0.0
    beta[at : at + width] *= -1
    rows = p.test
    e1, e0 = predict_residual(p, x, beta, rows), predict_residual(p, x, without, rows)
    return bool(np.mean(e1**2) < (1 - FLIPPED_BY_LUCK) * np.mean(e0**2))
