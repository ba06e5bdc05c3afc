"""Torque effects that come anew in every run: a brake, a preload, a warm-up, by the time since its start.
Only where there are several runs; in one, that is the session's own time."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from calibration.candidates.axis_torque import Friction, warmup
from calibration.candidates.candidate import Candidate, ramp
from calibration.readers.run import Array

ONSETS = 19  # tried within the longest run
TAUS = (0.1, 0.3, 1.0, 3.0)  # time constants, of the longest run

Shape = Callable[[Array], Array]


def in_every_run(f: Friction) -> list[Candidate]:
    """Candidates of the axis' torque; empty for a single run."""
    motion = f.level.motion
    starts = np.union1d([0], np.flatnonzero(motion.starts))
    if len(starts) < 2:
        return []
    index = np.arange(len(motion.theta))
    first = starts[np.searchsorted(starts, index, side="right") - 1]
    since = (index - first) * motion.period_s / motion.width
    longest = float(since.max())
    places = [float(x) for x in np.linspace(0.05, 0.95, ONSETS) * longest]
    places = [at for at in places if 0.02 < np.mean(since > at) < 0.98]
    out = [_begins("brake_drag", "torque", "N m", _drag(f, since), (at,), longest) for at in places]
    for at in places:
        where = (at, 0.02 * longest)
        out.append(_begins("preload_change", "fraction", "1", _preload(f, since), where, longest, most=1.0))
    return out + [_warms(f, since, part * longest) for part in TAUS]


def _begins(
    name: str,
    size: str,
    unit: str,
    shape: Shape,
    where: tuple[float, ...],
    longest: float,
    most: float = np.inf,
) -> Candidate:
    fixed = dict(zip(("onset_in_run", "ramp"), [(x, "s") for x in where], strict=False))
    return Candidate(
        name,
        "time",
        shape(np.array(where)),
        ((size, unit),),
        fixed=fixed,
        shape=shape,
        steps=(0.02 * longest, 0.01 * longest)[: len(where)],
        most=most,
    )


def _warms(f: Friction, since: Array, tau: float) -> Candidate:
    shape = warmup(f, since[f.level.motion.pick], since, viscous=True)
    return Candidate(
        "friction_warmup",
        "time",
        shape(np.array([tau])),
        (("amplitude", "1"),),
        fixed={"tau_in_run": (tau, "s")},
        shape=shape,
        steps=(0.2 * tau,),
    )


def _drag(f: Friction, since: Array) -> Shape:
    return lambda p: f.level.answer((since > p[0]).astype(float))[:, None]


def _preload(f: Friction, since: Array) -> Shape:
    here = since[f.level.motion.pick]

    def shape(p: Array) -> Array:
        full, part = (ramp(clock, float(p[0]), float(p[1])) for clock in (since, here))
        return (f.level.answer(f.level.stiction * full) + f.viscous * part)[:, None]

    return shape
