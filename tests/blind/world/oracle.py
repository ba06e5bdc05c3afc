"""What a least squares that knows the right column can tell: an effect's size, and the names beside it."""

from collections.abc import Mapping

import numpy as np

from tests.blind.world.made import TURN, Array

CLEAR = 10.0
"""Log-likelihood by which a rival must fall behind to be told apart; a ratio of e^10 (ASSUMPTION: 20 in -2 ln
L is far beyond what one or two free parameters gain by chance)."""


def left(y: Array, columns: Array) -> Array:
    """What the columns (n, k) do not take up of y."""
    scale = np.sqrt(np.mean(columns**2, axis=0)) + 1e-300
    x = columns / scale
    return np.asarray(y - x @ np.linalg.lstsq(x, y, rcond=1e-10)[0])


def rms(y: Array) -> float:
    """Root mean square."""
    return float(np.sqrt(np.mean(y**2)))


def ratio(own: Array, base: Array, floor: float) -> float:
    """The effect's own contribution beyond what the declared model takes up, over the floor of a row."""
    return rms(left(own, base)) / floor


def behind(y: Array, base: Array, right: Array, rival: Array) -> float:
    """Log-likelihood of the right columns over a rival's, white noise."""
    good, other = (left(y, np.column_stack([base, x])) for x in (right, rival))
    return float(0.5 * len(y) * np.log(np.sum(other**2) / np.sum(good**2)))


def rivals(y: Array, base: Array, right: Array, names: Mapping[str, Array]) -> tuple[str, ...]:
    """Names whose columns are not clearly worse than the right ones."""
    return tuple(name for name, x in names.items() if behind(y, base, right, x) < CLEAR)


def line(x: Array, order: float) -> Array:
    """(n, 2): cosine and sine of `order` cycles per unit of x."""
    return np.column_stack([np.cos(TURN * order * x), np.sin(TURN * order * x)])


def nearest(y: Array, base: Array, x: Array, start: float, span: float) -> Array:
    """The line over x, of an order within two cycles over `span` of `start`, that leaves the least of y."""
    orders = start + np.linspace(-2.0, 2.0, 41) / span
    fits = [rms(left(y, np.column_stack([base, line(x, order)]))) for order in orders]
    return line(x, float(orders[int(np.argmin(fits))]))
