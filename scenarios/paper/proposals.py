"""Starting points for the search: random points of the space, sifted by linear theory (screen.py).

For every drive that can do it, the disturbances are chosen, not drawn: together twice and once per motor
turn push the axis to its fold when it runs at the lowest open-loop speed; the mesh takes up what row E5
still lacks.
"""

from dataclasses import dataclass

import numpy as np

from plant.gears import ORDERS
from scenarios.paper.log import Array
from scenarios.paper.runs import HIGH, LOW, OPENED, OPENED_S, SLOW_SLEW
from scenarios.paper.scales import ARCSEC, COUNT_RATE
from scenarios.paper.screen import (
    Axis,
    Points,
    open_loop_room,
    responses_at,
    rule_gains,
    spectral_radius,
)
from scenarios.paper.space import SPACE
from scenarios.paper.statics import shortfalls_of

MOTOR, MESH = ORDERS["motor"], ORDERS["mesh1"]
QUANTUM = 0.7 * COUNT_RATE
"""arcsec/s that quantisation adds to a peak."""
LOWEST = (84.0, 90.0, 96.0)
"""arcsec/s, lowest open-loop speed aimed at."""
ONCE_SHARE = (0.05, 0.4)
"""Once per turn as a share of both; twice per turn has to stay the stronger line (E6)."""
MESH_PEAK = (2.6, 3.5, 4.5)
"""Percent: smallest closed-loop peak of E3 aimed at with the mesh."""
OPEN_PEAK = 12.5
"""Percent: largest open-loop peak aimed at with the imbalance."""
SLOW_TORQUE = 0.05
WORTH = 4.0
"""Expected violation above which a point is not looked at further."""
STABLE, UNSTABLE = 0.999, 1.002
"""Spectral radii per sample: growth or decay within a few seconds."""
SIEVE = (
    ("low", 600.0, True),
    ("low", 15.0, True),
    ("low", 100.0, True),
    ("low", 3600.0, True),
    ("high", 15.0, False),
)
"""(preload, arcsec/s, whether the loop has to be stable there)."""


@dataclass(frozen=True)
class Proposal:
    """A search vector (logarithms) and the violation that linear theory expects of it."""

    x: Array
    expected: float


def draw(random: np.random.Generator, count: int) -> Array:
    """Return `count` vectors, even on the logarithmic scale, shape (count, len(SPACE))."""
    low = np.log([free.low for free in SPACE])
    high = np.log([free.high for free in SPACE])
    return np.asarray(low + (high - low) * random.random((count, low.size)), dtype=np.float64)


def as_points(x: Array) -> Points:
    """Return the columns of vectors by name."""
    return {free.name: np.exp(x[:, k]) for k, free in enumerate(SPACE)}


def propose(
    random: np.random.Generator, scale: float, low_speed: bool = True, count: int = 300_000, keep: int = 24
) -> list[Proposal]:
    """Return the most promising of `count` random points, best first. scale, low_speed: as in statics.py."""
    x = draw(random, count)
    x = x[shortfalls_of(as_points(x), scale, low_speed) == 0.0]
    # two stages: the bristles do not matter for the quick rows, and eigenvalues are dear
    axis = Axis(as_points(x), scale)
    x = x[_velocity_rows(axis, rule_gains(axis), low_speed)[0] < WORTH]
    # the loop has to be stable at every speed of low preload, and unstable at tracking speed of high preload
    for preload, speed, wanted in SIEVE:
        axis = Axis(as_points(x), scale)
        radius = spectral_radius(axis, preload, rule_gains(axis), speed * ARCSEC)
        x = x[radius < STABLE if wanted else radius > UNSTABLE]
    axis = Axis(as_points(x), scale)
    expected, chosen = _velocity_rows(axis, rule_gains(axis), low_speed)
    for name, column in chosen.items():
        x[:, [free.name for free in SPACE].index(name)] = np.log(column)
    order = np.argsort(expected)[:keep]
    low_bound, high_bound = (np.log([getattr(free, side) for free in SPACE]) for side in ("low", "high"))
    return [Proposal(np.clip(x[k], low_bound, high_bound), float(expected[k])) for k in order]


def _velocity_rows(axis: Axis, gains: tuple[Array, Array], low_speed: bool) -> tuple[Array, dict[str, Array]]:
    """Return the expected violation of E3 to E6 with the best disturbances, and these disturbances.

    low_speed: whether E6 counts; without it the gears' torque is the share `SLOW_TORQUE` of Coulomb friction.
    """
    n = gains[0].size
    opened, closed = responses_at(axis, 2 * MOTOR, gains, [LOW])
    left = closed[0] / opened[0]
    speeds = np.array(HIGH)
    twice = responses_at(axis, 2 * MOTOR, gains, HIGH)
    once = responses_at(axis, MOTOR, gains, HIGH)
    mesh = responses_at(axis, MESH, gains, HIGH)
    # the imbalance at the end of the open-loop runs, as a share of its amplitude, and how the axis yields
    ends = [HIGH.index(speed) for speed in OPENED]
    swing = np.sin(np.minimum(np.array(OPENED) * OPENED_S * ARCSEC, np.pi / 2.0))
    stiffness = axis.damping + axis.table("low", "viscous")
    fast = np.array(SLOW_SLEW)
    fast_twice = responses_at(axis, 2 * MOTOR, gains, SLOW_SLEW)[1]
    fast_once = responses_at(axis, MOTOR, gains, SLOW_SLEW)[1]

    def percent(rates: Array, at: Array) -> Array:
        return (rates / ARCSEC + QUANTUM) / at[:, None] * 100.0

    best = np.full(n, np.inf)
    found = {name: np.ones(n) for name in ("twice", "once", "mesh", "imbalance")}
    for lowest in LOWEST:
        room, fold = open_loop_room(axis, lowest)
        if not low_speed:
            room = np.full(n, SLOW_TORQUE * axis.table("low", "coulomb"))
        for share in ONCE_SHARE:
            a2, a1 = room * (1.0 - share), room * share
            slow_open = a2 * twice[0] + a1 * once[0]
            slow_closed = a2 * twice[1] + a1 * once[1]
            slew = percent(a2 * fast_twice + a1 * fast_once, fast).max(0)
            for bottom in MESH_PEAK:
                wanted = (bottom / 100.0 * speeds[:, None] - QUANTUM) * ARCSEC
                am = np.clip(np.max((wanted - slow_closed) / mesh[1], 0), 0.1, 15.0)
                e3 = percent(slow_closed + am * mesh[1], speeds)
                gears = slow_open + am * mesh[0]
                slack = (OPEN_PEAK / 100.0 * speeds[:, None] - QUANTUM) * ARCSEC - gears
                ag = np.min((slack * stiffness)[ends] / swing[:, None], 0)
                amplitude = a2 * opened[0] / ARCSEC
                miss = (
                    np.maximum(0.0, e3.max(0) - 6.3)
                    + 2.0 * np.maximum(0.0, 2.4 - e3.min(0))
                    + 3.0 * np.maximum(0.0, slew - 0.9)
                    + 0.05 * np.maximum(0.0, ag - 100.0)
                    + 0.2 * np.maximum(0.0, 5.0 - ag)
                    + np.where(room > 0.0, 0.0, 20.0)
                )
                if low_speed:
                    miss = (
                        miss
                        + 10.0 * np.maximum(0.0, left - 0.25)
                        + 0.1 * np.maximum(0.0, np.where(np.isfinite(fold), fold, 1e3) - lowest)
                        + 0.3 * np.maximum(0.0, 5.0 - amplitude)
                    )
                better = miss < best
                best = np.where(better, miss, best)
                for name, column in (("twice", a2), ("once", a1), ("mesh", am), ("imbalance", ag)):
                    found[name] = np.where(better, np.maximum(column, 0.05), found[name])
    return best, found
