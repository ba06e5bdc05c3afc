"""The response's filter, where declared waves ask for a narrower one than the position's rates have."""

from collections.abc import Callable

import numpy as np

from calibration.arrays import Array
from calibration.balances.filters import Filter
from calibration.balances.problem import Problem
from calibration.balances.view import View, choose_rows

# times the mean square that a balance leaves behind the wide filter, by coefficients of two filters, at most.
# ASSUMPTION: measured arms have 1.0 and 1.1 (ur10e), one whose joint is quick behind a coarse encoder 17
DISAGREE = 2.0


def one_filter(view: View, made: Callable[[], Problem]) -> None:
    """Filter the response like the rates where coefficients fitted behind two filters are wrong behind one.

    A narrower filter lets quick waves through that the position's rates cannot follow. Where the drive
    accelerates as quickly, the response then holds what its inertia's column lacks, and every term is biased.
    """
    if view.rates <= view.sigma:
        return
    shown, two = (view.filter, view.rows), _terms(made())
    view.filter = Filter(view.rates)
    choose_rows(view)
    p = made()
    left = [float(np.mean((p.y - p.base @ x)[p.valid] ** 2)) for x in (two, _terms(p))]
    if left[0] <= DISAGREE * left[1]:
        view.filter, view.rows = shown


def _terms(p: Problem) -> Array:
    return np.asarray(np.linalg.lstsq(p.base[p.valid], p.y[p.valid], rcond=None)[0])
