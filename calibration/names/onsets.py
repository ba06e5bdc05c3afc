"""Friction that changes from one time on: shared by the names that do."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from calibration.arrays import Array
from calibration.balances.candidate import Candidate, ramp
from calibration.names.candidates import tried
from calibration.names.scene import Scene

# share of the time, at either end: a step there is how a run begins or ends. ASSUMPTION
EDGE = 0.04
# places of an onset that are tried. ASSUMPTION: time against steps missed
TRIALS = 24
# part of the time, between which they lie: clear of EDGE. ASSUMPTION
PLACES = (0.06, 0.94)
# part of the time before it, from where a slow change may have begun. ASSUMPTION
BEFORE = 0.4
# part of the time, that a slow change's length moves by at first. ASSUMPTION
LENGTH_STEP = 0.008


@dataclass(frozen=True, kw_only=True)
class Begins:
    """An effect that begins at some time.

    size: its size's label. weigh: its columns (n_fitted,) from a step (n,) at full rate. lengths (of the
    time): those that are tried where it takes its time. step (of the time): how far onset and length surely
    lie off, where that is more than the grid's own.
    """

    name: str
    size: tuple[str, str]
    weigh: Callable[[Array], Array]
    lengths: tuple[float, ...] = ()
    sign: int = 0
    most: float = np.inf
    in_every_run: bool = True  # or by the clock that all files share only
    step: float = 0.0


def steps(s: Scene, what: Begins) -> list[Candidate]:
    """Candidates at one time of the clock that all files share, and at the same time of every file.

    In the latter a change's length is not told from a short one.
    """
    out = []
    for clock in s.clocks if what.in_every_run else ("start",):
        first = clock == "start"
        if not what.lengths:
            out += _begun(s, what, clock, PLACES)
        for part in what.lengths if first else what.lengths[:1]:
            out += _begun(s, what, clock, (-BEFORE if first else EDGE, 1 - EDGE), part)
    return out


def _begun(
    s: Scene, what: Begins, clock: str, places: tuple[float, float], part: float = 0.0
) -> list[Candidate]:
    """Between two `places` of the time: a step, or a ramp over `part` of it."""
    since, sudden = s.clocks[clock], 2 * s.view.period_s * max(s.view.step, 1)
    span = float(since.max())

    def shape(p: Array) -> Array:
        if part:
            return what.weigh(ramp(since, float(p[0]), float(p[1])))[:, None]
        at = float(np.clip(p[0], EDGE * span, (1 - EDGE) * span))
        return what.weigh(np.clip((since - at) / sudden, 0.0, 1.0))[:, None]

    length = {"duration": (part * span, "s")} if part else {}
    small = (span / TRIALS / 3, LENGTH_STEP * max(10 * part, 1.0) * span)[: 1 + len(length)]
    more: dict[str, Any] = {"domain": "time", "sign": what.sign, "most": what.most}
    more["steps"] = tuple(max(x, what.step * span) for x in small)
    tries = ({clock: (float(at), "s"), **length} for at in np.linspace(*places, TRIALS) * span)
    return [tried(what.name, shape, what.size, at=fixed, **more) for fixed in tries]
