"""An effect outside the catalogue: a smooth function of the domain it was found in, given by knots.

`domain` is the signal it depends on. `kind` is 1 (linear), 3 (cubic) or 5 (a sum of stops). `period` is 0, or
the domain wraps and the knots lie within one period. `motor` is 0 (both), 1 (A) or 2 (B), of a target that
belongs to a motor. Up to 32 knots x0, y0, x1, y1 … follow, in SI units.

A sum of at most 12 stops is a hysteresis: every knot is (radius, height) and adds height * z / radius. z
follows the domain and is held within +-radius."""

from math import floor

from plant.compiled import Floats, inner
from plant.effects.base import Effect, Term
from plant.effects.signals import MEMORY, MOTOR

KNOTS = 32
STOPS = 12
# places behind the memory; knots are x's, then y's; a stop's state lies STATES behind its height
DOMAIN, KIND, PERIOD, COUNT, CHOICE, FIRST = 0, 1, 2, 3, 4, 5
STATES = 16
KINDS = {"linear": 1.0, "cubic": 3.0, "stop": 5.0}


@inner
def slope(p: Floats, k: int, count: int) -> float:
    """Return the slope at a knot: that of the parabola through its neighbours, one-sided at the ends.

    Where the knots span one whole period and close, the neighbours of the ends are those across it.
    """
    a = max(k - 1, 0)
    b = min(k + 1, count - 1)
    xs = MEMORY + FIRST
    ys = xs + KNOTS
    left = p[xs + k] - p[xs + a]
    right = p[xs + b] - p[xs + k]
    if a == k or b == k:
        span = p[xs + count - 1] - p[xs]
        whole = count > 2 and p[ys] == p[ys + count - 1] and abs(span - p[MEMORY + PERIOD]) < 1e-9 * span
        if not whole:
            return (p[ys + b] - p[ys + a]) / (p[xs + b] - p[xs + a])
        a = count - 2
        b = 1
        left = p[xs + count - 1] - p[xs + a]
        right = p[xs + b] - p[xs]
    before = (p[ys + k] - p[ys + a]) / left
    after = (p[ys + b] - p[ys + k]) / right
    return (before * right + after * left) / (left + right)


@inner
def stops(p: Floats) -> float:
    """Return the sum of the stops at their states."""
    total = 0.0
    ys = MEMORY + FIRST + KNOTS
    for k in range(int(p[MEMORY + COUNT])):
        total += p[ys + k] * p[ys + STATES + k] / p[ys - KNOTS + k]
    return total


def formula(x: Floats, p: Floats) -> float:
    """Return the function of its domain at the signal vector; constant beyond the outer knots."""
    if p[MEMORY + CHOICE] != 0.0 and p[MEMORY + CHOICE] != x[MOTOR] + 1.0:
        return 0.0
    if p[MEMORY + KIND] > 4.0:
        return stops(p)
    u = x[int(p[MEMORY + DOMAIN])]
    count = int(p[MEMORY + COUNT])
    xs = MEMORY + FIRST
    ys = xs + KNOTS
    period = p[MEMORY + PERIOD]
    if period > 0.0:
        u -= period * floor((u - p[xs]) / period)
    if count == 1 or u <= p[xs]:
        return p[ys]
    if u >= p[xs + count - 1]:
        return p[ys + count - 1]
    k = 0
    while u >= p[xs + k + 1]:
        k += 1
    width = p[xs + k + 1] - p[xs + k]
    s = (u - p[xs + k]) / width
    y0, y1 = p[ys + k], p[ys + k + 1]
    if p[MEMORY + KIND] < 2.0:
        return y0 + s * (y1 - y0)
    m0 = slope(p, k, count) * width
    m1 = slope(p, k + 1, count) * width
    return y0 + s * (m0 + s * (3.0 * (y1 - y0) - 2.0 * m0 - m1 + s * (m0 + m1 - 2.0 * (y1 - y0))))


def update(x: Floats, dt: float, p: Floats) -> None:
    """Let the stops follow the domain (p[0]: its last value; p[1]: 1 once there is one)."""
    if p[MEMORY + KIND] < 4.0:
        return
    u = x[int(p[MEMORY + DOMAIN])]
    moved = u - p[0] if p[1] > 0.0 else 0.0
    p[0] = u
    p[1] = 1.0
    xs = MEMORY + FIRST
    at = xs + KNOTS + STATES
    for k in range(int(p[MEMORY + COUNT])):
        p[at + k] = min(p[xs + k], max(-p[xs + k], p[at + k] + moved))


EFFECT = Effect(
    name="unknown",
    catalogue_row=41,
    channel="T",
    domain="axis_angle",
    equation="y = f(domain) through the knots, linear or cubic (Hermite), or a sum of stops",
    parameters=(),
    source="docs/sources/effects.md: an effect outside the catalogue enters as a smooth function",
    terms=(Term("target", formula, update, lasting=True),),
)
