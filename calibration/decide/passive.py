"""Signs as bounds: a fit with a negative inertia, or friction that feeds energy, names nothing."""

from __future__ import annotations

import numpy as np

from calibration.decide.select import Selection
from calibration.decide.withdraw import Refused
from calibration.finding import Finding

#: numbers of the declared model that are positive in every drive, by channel
POSITIVE = {"T": ("inertia", "viscous", "coulomb"), "E": ("resistance", "torque_constant")}
SURE = 2.0  # standard errors below zero, before a sign counts as wrong


def against_nature(s: Selection, channel: str) -> str:
    """The first number of the final fit whose sign no drive has, in words; empty when all are sound."""
    for k, (name, unit) in enumerate(s.problem.base_labels):
        if name in POSITIVE.get(channel, ()):
            value, error = float(s.after.beta[k]), float(np.sqrt(max(s.after.covariance[k, k], 0.0)))
            if value < -SURE * error:
                return f"{name} would be {value:.3g} {unit}"
    return ""


def sound(findings: list[Finding], selections: dict[str, Selection]) -> tuple[list[Finding], list[Refused]]:
    """Findings of channels whose fit keeps the signs, and a refusal for each of the others."""
    wrong = {c: against_nature(selections[c], c) for c in POSITIVE if c in selections}
    kept = [f for f in findings if not wrong.get(f.channel)]
    refused = [
        (f.channel, f.name, f"withdrawn: beside it {wrong[f.channel]}")
        for f in findings
        if wrong.get(f.channel)
    ]
    return kept, refused
