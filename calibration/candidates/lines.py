"""Lines over angle: every stage of the gear table, and the scan for an order that no stage has."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate, sine_columns
from calibration.candidates.context import Context

NAMES = {"axis": "gravity_imbalance", "mesh1": "gear_mesh", "mesh2": "gear_mesh", "mesh3": "gear_mesh"}
FREE_TURNS = 5.0  # cycles within the travel before an order that no stage has is a line and not a bend
ENOUGH = 1.2  # turns of a line needed before its two coefficients mean anything


def stage_lines(
    c: Context, harmonics: dict[str, int] | None = None, names: dict[str, str] | None = None
) -> list[Candidate]:
    """A sine pair per session at every harmonic of every stage that the log travels far enough for."""
    out = []
    span = float(np.ptp(c.angle))
    for stage, per_unit in c.stages.items():
        for h in range(1, (harmonics or {}).get(stage, 2) + 1):
            rate = per_unit * h
            if span * rate < ENOUGH or not resolvable(c, rate):
                continue
            name = (names or NAMES).get(stage, "gear_eccentricity")
            out.append(
                Candidate(
                    name,
                    "motor_angle" if stage == "motor" else "axis_angle",
                    sine_columns(c.angle * rate, c.session),
                    (("amplitude", c.unit),),
                    kind="line",
                    stage=stage,
                    harmonic=h,
                    order=rate * c.turn,
                )
            )
    return out


def resolvable(c: Context, rate: float) -> bool:
    """False when most rows move more than 0.45 of the line's period per sample."""
    step = float(np.median(np.diff(c.t)))
    return bool(np.mean(np.abs(c.speed) * rate * step < 0.45) > 0.3)


def free_lines(c: Context, count: int = 220, top: float | None = None) -> list[Candidate]:
    """Orders that no stage has, on a grid fine enough for the travel: a bearing, or something unknown."""
    span = float(np.ptp(c.angle))
    if span <= 0:
        return []
    quickest = float(np.quantile(np.abs(c.speed), 0.9)) * float(np.median(np.diff(c.t)))
    highest = min(top or 1e9, 0.4 / quickest if quickest > 0 else 1e9, count / (2 * span))
    rates = np.arange(FREE_TURNS, highest * span, 0.5) / span
    taken = [r * h for r in c.stages.values() for h in (1, 2, 3)]
    out = []
    for rate in rates[:count]:
        if any(abs(rate - r) * span < 0.6 for r in taken):
            continue
        out.append(
            Candidate(
                "bearing_pass",
                "axis_angle",
                sine_columns(c.angle * rate, c.session),
                (("amplitude", c.unit),),
                kind="line",
                order=float(rate * c.turn),
            )
        )
    return out
