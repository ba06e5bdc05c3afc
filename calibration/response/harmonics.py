"""A stage's harmonics that were taken as one candidate, told one by one."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from calibration.decide.parameters import amplitude_interval, finding_of, interval
from calibration.decide.select import Selection
from calibration.finding import Finding, Parameter

FEW = 6  # harmonics that are all told, because the evidence is theirs together
CLEAR = 3.0  # standard errors of an amplitude that is told among more


def findings_of(s: Selection, index: int) -> list[Finding]:
    """The chosen effect as findings: one, or one per harmonic (the evidence is that of all together)."""
    c = s.chosen[index].candidate
    whole = finding_of(s, index)
    if "frequency" in whole.parameters:  # as refined
        whole.frequency = whole.parameters["frequency"].value
    sessions = _sessions(s, index)
    pairs = c.width // 2 // max(sessions, 1)
    if c.kind != "line" or c.harmonic is not None or c.stage is None or pairs < 2:
        return [whole]
    at = s.problem.base.shape[1] + sum(x.candidate.width for x in s.chosen[:index])
    blocks = int(s.problem.train.sum() / s.problem.block)
    out = []
    for h in range(pairs):
        first = at + 2 * sessions * h
        found = []
        for k in range(sessions):
            pair = slice(first + 2 * k, first + 2 * k + 2)
            beta, cov = s.after.beta[pair], s.after.covariance[pair, pair]
            found.append((*amplitude_interval(beta, cov, blocks), beta, cov))
        # the phase is the section's that shows the line best: one that is held out shows none
        value, low, high, beta, cov = max(found, key=lambda f: f[0])
        spread = float(np.sqrt(max(np.trace(cov) / 2, 0.0)))
        phase = float(np.arctan2(-beta[1], beta[0]))
        around = interval(phase, min(spread / max(value, 1e-300), 2.0), blocks, 0.0)
        if pairs > FEW and value < CLEAR * spread:
            continue
        unit = c.labels[0][1]
        parameters = {c.labels[0][0]: Parameter(value, unit, low, high)}
        parameters["phase"] = Parameter(phase, "rad", *around)
        order = c.order * (h + 1) if c.order else None
        out.append(replace(whole, harmonic=h + 1, order=order, parameters=parameters))
    return sorted(out, key=lambda f: -f.parameters[c.labels[0][0]].value) or [whole]


def _sessions(s: Selection, index: int) -> int:
    """Pairs per harmonic: rows of one session have non-zero columns in one pair only."""
    x = s.chosen[index].candidate.columns
    rows = np.abs(x).max(axis=1) > 0
    if not rows.any():
        return 1
    used = int(np.count_nonzero(x[np.argmax(rows)]))
    return int(max(round(x.shape[1] / max(used, 1)), 1))
