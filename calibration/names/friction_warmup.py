"""Friction that falls as the drive warms up."""

from itertools import product

import numpy as np

from calibration.names.inplant import Facts, Made, as_found
from calibration.names.name import Array, Beside, Candidate, Finding, Name, Scene, candidate, grid, unstated
from calibration.names.scene import since_first

# part of the time from the first row to the last: time constants that are tried. ASSUMPTION
PARTS = (0.05, 0.1, 0.2, 0.4, 0.8)
LONGEST = 1.0  # times that time, for a time constant: a slower one is a slope. ASSUMPTION
OF_COULOMB = "of_coulomb"


def columns(s: Scene) -> list[Candidate]:
    """Friction, or what of it knows no speed, times exp(-time / tau) or times the temperature.

    The time is on the clock that all files share, where there is one, or from the start of every file.
    Friction falls as the depth is negative.
    """
    if lacks(s):
        return []
    known = s.declared.get("coulomb", 0.0) > 0 and s.declared.get("viscous", 0.0) > 0
    # all files of a rig are one session
    session = np.zeros(len(s.view.clock)) if s.pair is None else s.pair.motion.frame.session
    clocks = [("time_constant", since_first(s.view.clock, session))] * ("start" in s.clocks)
    clocks += [("time_constant_in_run", x) for start, x in s.clocks.items() if start != "start"]
    parts = product((False, True) if known else (False,), clocks)
    out = [one for of_coulomb, clock in parts for one in _cooling(s, *clock, of_coulomb)]
    t = s.temperature
    if t is not None and s.pair is None:
        size = ("depth", "1/K")
        out.append(candidate(NAME.name, _friction(s, t - t.mean()), size, domain="temperature", sign=-1))
    return out


def lacks(s: Scene) -> str:
    """Friction, of which a depth is a part: beside none that knows no speed the warm-up takes its place."""
    known = s.pair is not None or any(s.declared.get(n, 0.0) > 0 for n in ("coulomb", "viscous"))
    return "" if known and not unstated(s, "coulomb") else "declared friction ('coulomb'), which changes"


def _friction(s: Scene, change: Array, of_coulomb: bool = False) -> Array:
    """The declared friction times `change` (n,), or what of it knows no speed."""
    level = s.answer(s.sliding.steady * change)
    return level if of_coulomb else level + s.at(s.sliding.drag * change)


def _cooling(s: Scene, name: str, since: Array, of_coulomb: bool) -> list[Candidate]:
    """Friction times exp(-since / tau) for the time constants that are tried."""
    span = float(since.max()) or 1.0

    def shape(p: Array) -> Array:
        tau = float(np.clip(p[0], 1e-3 * span, LONGEST * span))
        return -_friction(s, np.exp(-since / tau), of_coulomb)[:, None]

    which = {OF_COULOMB: (1.0, "0 all friction, 1 what knows no speed")} if of_coulomb else {}
    along = (name, [part * span for part in PARTS], "s")
    return grid(NAME.name, shape, "depth", along=along, beside=which, sign=-1)


def to_plant(f: Finding, facts: Facts) -> Made:
    """As it is found, but for what the plant cannot say."""
    made = as_found(f, facts)
    if OF_COULOMB in f.parameters:
        made.remarks.append("friction_warmup: the plant scales Tc, Ts and sigma2 alike, by the rise of Tc")
    return made


NAME = Name(
    name="friction_warmup",
    columns=columns,
    relative={"depth": ("coulomb", 1)},
    lacks=lacks,
    to_plant=to_plant,
    experiment="repeat the same run after a rest of half an hour: a warm-up comes back",
    beside=Beside(single=True),
)
