"""Friction that steps at one time: shared by the names that do."""

from __future__ import annotations

import numpy as np

from calibration.candidates.candidate import Candidate
from calibration.names.scene import Scene
from calibration.readers.run import Array

EDGE = 0.04  # of the time, at either end: a step there is how a run begins or ends
TRIALS = 24  # onsets that are tried


def steps(s: Scene, name: str, weight: Array, label: tuple[str, str], sign: int) -> list[Candidate]:
    """A step of `weight` (full rate) at one time of the clock that all files share; and at the same time of
    every file."""
    v = s.view
    out = []
    for clock, where in ((v.clock - v.clock.min(), "onset"), (v.t, "onset_in_run")):
        if where == "onset_in_run" and len(np.unique(v.file)) < 2:
            continue
        span = float(clock.max())

        def full(p: Array, clock: Array = clock, span: float = span) -> Array:
            at = float(np.clip(p[0], EDGE * span, (1 - EDGE) * span))
            return np.asarray(weight * np.clip((clock - at) / (2 * v.period_s * max(v.step, 1)), 0.0, 1.0))

        shape = s.shaped(full)
        for at in np.linspace(0.06, 0.94, TRIALS) * span:
            out.append(
                Candidate(
                    name,
                    "time",
                    shape(np.array([at])),
                    (label,),
                    sign=sign,
                    fixed={where: (float(at), "s")},
                    shape=shape,
                    steps=(span / TRIALS / 3,),
                    searched=1,
                )
            )
    return out
