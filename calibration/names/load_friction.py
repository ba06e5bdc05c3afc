"""Friction that grows with the load that the drive carries."""

import numpy as np

from calibration.balances.balance import term_of
from calibration.balances.slowoffset import SLOW
from calibration.names.name import Candidate, Name, Scene, candidate
from calibration.names.scene import VARIES
from calibration.names.unknown_alone import SETTLED
from calibration.statistics.regression import solve

MOST = 0.5  # part of the force that rubs, at most. ASSUMPTION: the plant's bound, five times its default
#: terms that are no load: what the amplifier's zero does
ZERO = ("drift", SLOW)
APPLIED = "applied"
#: terms that the motor carries, and the load does not
FRICTION = ("coulomb", "viscous")


def columns(s: Scene) -> list[Candidate]:
    """The load against the motion: what the motor makes, or what is left of that behind all friction.

    Of the motion, not of the response, whose noise it would share. Where what is left does not rub, what the
    motor makes is friction that is badly known.
    """
    if s.pair is not None:  # through both trains, which pull against each other
        load = np.abs(s.pair.load) + 2 * np.abs(s.pair.lagging)
        return [_of(s, np.interp(np.arange(len(s.view.t)), s.view.rows, load))]
    if lacks(s) or not s.both:
        return []
    p, (carried, some) = s.problem, _settled(s, ZERO + FRICTION, False)
    x = np.hstack([p.base, carried.columns])[p.train]
    if solve(x, p.y[p.train])[-1] <= 0:
        return []
    # of one size the load has Coulomb's friction
    return [c for c, varies in (_settled(s, ZERO, True), (carried, some)) if varies]


def _settled(s: Scene, without: tuple[str, ...], itself: bool) -> tuple[Candidate, bool]:
    """Friction in proportion to the force that the terms make, but some; with itself or without.

    And whether that force varies in size.
    """
    p, found = s.problem, np.zeros((len(s.problem.y), 1))
    constants = [(n, x) for n, x in s.view.rig.constants.items() if n not in without]
    known = sum((x * s.at(term_of(s.view, n)[0][2]) for n, x in constants), np.zeros(1))
    carried = np.array([n not in without for n, _ in p.base_labels] + [itself])
    # what is applied may switch its sign, and then its size behind a filter is another one
    sharp = np.array([n == APPLIED for n, _ in p.base_labels] + [False])
    full = term_of(s.view, APPLIED)[0][2] if sharp.any() else 0.0
    for _ in range(SETTLED):
        x = np.hstack([p.base, found])
        beta = solve(x[p.train], p.y[p.train])
        smooth = x[:, carried & ~sharp] @ beta[carried & ~sharp] + known
        behind = np.interp(np.arange(len(s.view.t)), s.view.rows, smooth)
        load = np.abs(behind + float(beta[sharp].sum()) * full)
        one = _of(s, load)
        found = one.columns
    return one, bool(np.std(load[s.view.ok]) > VARIES * np.mean(load[s.view.ok]))


def _of(s: Scene, load: np.ndarray) -> Candidate:
    return candidate(NAME.name, s.answer(load), "coefficient", sign=1, most=MOST)


def lacks(s: Scene) -> str:
    """A load beside friction."""
    if "applied" in s.declared or (s.view.dynamic and (s.weighed or "inertia" in s.declared)):
        return ""
    return "a load beside friction: accelerations, a weight, or what is applied"


NAME = Name(name="load_friction", columns=columns, experiment="the same motion with two loads", lacks=lacks)
