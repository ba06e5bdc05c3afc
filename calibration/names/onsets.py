"""Friction that changes from one time on: shared by the names that do."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate, ramp
from calibration.names.name import Scene, tried

EDGE = 0.04  # share of the time, at either end: a step there is how a run begins or ends. ASSUMPTION
TRIALS = 24  # places of an onset that are tried. ASSUMPTION: time against steps missed
PLACES = (0.06, 0.94)  # part of the time, between which they lie: clear of EDGE. ASSUMPTION
BEFORE = 0.4  # part of the time before it, from where a slow change may have begun. ASSUMPTION
LENGTH_STEP = 0.008  # part of the time, that a slow change's length moves by at first. ASSUMPTION


def steps(
    s: Scene,
    name: str,
    size: tuple[str, str],
    weigh: Callable[[Array], Array],
    lengths: tuple[float, ...] = (),
    in_every_run: bool = True,
    surely: float = 0.0,
    **more: Any,
) -> list[Candidate]:
    """An effect that begins at one time of the clock that all files share, or at the same time of every file.

    In the latter (`in_every_run`) a change's length is not told from a short one. weigh: columns (n_fitted,)
    from a step (n,) at full rate. lengths (of the time): those that are tried. surely (of the time): how far
    onset and length lie off, where that is more than the grid's own. more: `Candidate`'s fields.
    """
    out = []
    for clock, since in s.clocks.items():
        whole, span = clock == "start", float(since.max())
        places = (-BEFORE if whole else EDGE, 1 - EDGE) if lengths else PLACES
        for part in ((lengths if whole else lengths[:1]) or (0.0,)) if whole or in_every_run else ():
            shape = partial(_begun, s, since, part, weigh)
            length = {"duration": (part * span, "s")} if part else {}
            small = (span / TRIALS / 3, LENGTH_STEP * max(10 * part, 1.0) * span)[: 1 + len(length)]
            form: dict[str, Any] = {"domain": "time", "steps": tuple(max(x, surely * span) for x in small)}
            tries = ({clock: (float(at), "s"), **length} for at in np.linspace(*places, TRIALS) * span)
            out += [tried(name, shape, size, at=fixed, **form, **more) for fixed in tries]
    return out


def _begun(s: Scene, since: Array, part: float, weigh: Callable[[Array], Array], p: Array) -> Array:
    """Columns (n_fitted, 1) from the onset p[0] on: a step, or with a `part` of the time a ramp over p[1]."""
    if part:
        return weigh(ramp(since, float(p[0]), float(p[1])))[:, None]
    span, sudden = float(since.max()), 2 * s.view.period_s * max(s.view.step, 1)
    at = float(np.clip(p[0], EDGE * span, (1 - EDGE) * span))
    return weigh(np.clip((since - at) / sudden, 0.0, 1.0))[:, None]
