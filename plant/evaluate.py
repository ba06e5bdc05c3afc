"""The formulas of the effects over the columns of a log: what calibration fits is what the kernel calls."""

from collections.abc import Mapping

import numpy as np

from plant.compiled import Floats, kernel
from plant.effects import REGISTRY, unknown
from plant.effects.base import Term
from plant.effects.signals import ANGLE, MEMORY, RATE, SEED, SIGMA0, TIME, VECTOR, Hook
from plant.kernels.dispatch import update, value
from plant.kernels.friction import steady
from plant.kernels.layout import ROW, ROW_MEMORY
from plant.rows import KINDS, vector


@kernel
def values_over(kind: int, rows: Floats, p: Floats, y: Floats) -> None:
    """Fill y with a term's values, memory advancing with the time column."""
    for k in range(rows.shape[0]):
        if k > 0:
            update(kind, rows[k], p, rows[k, TIME] - rows[k - 1, TIME])
        y[k] = value(kind, rows[k], p)


@kernel
def friction_over(kind: int, rows: Floats, p: Floats, y: Floats) -> None:
    """Fill y with the change of the steady friction torque on the axis, N m, positive accelerates."""
    for k in range(rows.shape[0]):
        x = rows[k]
        if k > 0:
            update(kind, x, p, x[TIME] - rows[k - 1, TIME])
        before = steady(x[RATE], x, SIGMA0)
        value(kind, x, p)
        y[k] = before - steady(x[RATE], x, SIGMA0)


def signals(count: int, columns: Mapping[int, Floats]) -> Floats:
    """Return `count` signal vectors with the given columns (plant/effects/signals.py), zero elsewhere."""
    rows = np.zeros((count, VECTOR))
    for place, column in columns.items():
        rows[:, place] = column
    return rows


def evaluate_function(knots: Floats, heights: Floats, u: Floats, period: float = 0.0) -> Floats:
    """Return the cubic function through (knots, heights) at `u`, as an `unknown` of the plant computes it."""
    p = np.zeros(ROW - ROW_MEMORY)
    count = len(knots)
    p[MEMORY + unknown.DOMAIN], p[MEMORY + unknown.KIND] = ANGLE, unknown.KINDS["cubic"]
    p[MEMORY + unknown.PERIOD], p[MEMORY + unknown.COUNT] = period, count
    first = MEMORY + unknown.FIRST
    p[first : first + count] = knots
    p[first + unknown.KNOTS : first + unknown.KNOTS + count] = heights
    y = np.zeros(len(u))
    values_over(KINDS[unknown.formula], signals(len(u), {ANGLE: u}), p, y)
    return y


def evaluate(
    name: str,
    rows: Floats,
    numbers: Mapping[str, float],
    term: int = 0,
) -> Floats:
    """Return one value per row, in the unit of the term's hook.

    rows: (n, VECTOR) signal vectors in time order. numbers: what the effect's formulas name, SI units: all
    parameters, order (cycles per axis turn) and constants, and a `seed` for noise. Memory begins at zero.
    Friction terms need the friction parameters in the vectors and give the change of the steady torque on the
    axis, N m.
    """
    effect = REGISTRY[name]
    chosen: Term = effect.terms[term]
    p = np.zeros(ROW - ROW_MEMORY)
    p[SEED] = numbers.get("seed", 0.0)
    p[MEMORY : MEMORY + len(effect.numbers)] = vector(effect, numbers)
    y = np.zeros(len(rows))
    kind = KINDS[chosen.formula]
    work = np.array(rows, dtype=float)
    if chosen.hook == Hook.FRICTION:
        friction_over(kind, work, p, y)
    else:
        values_over(kind, work, p, y)
    return y
