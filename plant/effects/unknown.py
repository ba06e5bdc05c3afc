"""An effect outside the catalogue: a smooth function of the domain it was found in, given by knots.

Parameters are `target` (where it acts), `domain` (the signal it depends on), `kind` (1 linear, 3 cubic),
`period` (0: none; else the domain wraps, knots within one period), and up to 32 knots x0, y0, x1, y1 … in SI
units."""

from math import floor

from plant.compiled import Floats, inner
from plant.effects.base import Effect, Term
from plant.effects.signals import MEMORY

KNOTS = 32
DOMAIN, KIND, PERIOD, COUNT, FIRST = 0, 1, 2, 3, 4  # places behind the memory; knots are x's, then y's


@inner
def slope(p: Floats, k: int, count: int) -> float:
    """Return the slope at a knot: that of the parabola through its neighbours, one-sided at the ends."""
    a = max(k - 1, 0)
    b = min(k + 1, count - 1)
    xs = MEMORY + FIRST
    ys = xs + KNOTS
    if a == k or b == k:
        return (p[ys + b] - p[ys + a]) / (p[xs + b] - p[xs + a])
    left = p[xs + k] - p[xs + a]
    right = p[xs + b] - p[xs + k]
    before = (p[ys + k] - p[ys + a]) / left
    after = (p[ys + b] - p[ys + k]) / right
    return (before * right + after * left) / (left + right)


@inner
def formula(x: Floats, p: Floats) -> float:
    """Return the function of its domain at the signal vector; constant beyond the outer knots."""
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


EFFECT = Effect(
    name="unknown",
    channel="T",
    domain="axis_angle",
    equation="y = f(domain) through the knots, linear or cubic (Hermite)",
    parameters=(),
    source="issue 3: an effect outside the catalogue enters as a smooth function",
    terms=(Term("target", formula),),
)
