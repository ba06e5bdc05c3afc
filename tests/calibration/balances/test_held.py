"""Which rows are held out, and which of them a fit tells."""

import numpy as np

from calibration.balances.balance import _excess
from calibration.balances.problem import Problem

ROWS = 400


def test_a_column_of_one_value_goes_beyond_nothing() -> None:
    """A constant speed whose last digit drifts, beside one that really grows."""
    mine = np.arange(ROWS) >= ROWS - 100
    ramp = np.linspace(0.0, 1.0, ROWS)
    assert _excess([3.47 + 1e-12 * ramp], mine, ~mine) < 0.01
    assert _excess([3.47 + 1.0 * ramp], mine, ~mine) > 0.3


def test_rows_need_not_be_told_of_what_is_fitted_there_anew() -> None:
    """Two files, each with an offset and a slope of its own; the weight is all but a line in the first."""
    t = np.tile(np.linspace(-1, 1, ROWS), 2)
    file = np.repeat([0, 1], ROWS)
    fresh = np.column_stack([(file == k) * z for k in (0, 1) for z in (np.ones_like(t), t)])
    weight = np.where(file == 0, t + 1e-3 * t**2, 50.0 + t + 1e-3 * t**2)
    base = np.column_stack([weight, fresh])
    names = [("gravity", "N m")] + 4 * [("slow_offset", "N m")]
    p = Problem(
        channel="T", unit="N m", y=t, base=base, base_labels=names, t=np.arange(2.0 * ROWS), run=file,
        session=file, valid=np.ones(2 * ROWS, dtype=bool), held=file == 1, period_s=1.0, ar_order=0,
        block_s=20.0, fresh=fresh,
    )  # fmt: skip
    assert p.told().untold == 0.0
    assert p.__class__(**{**vars(p), "fresh": None}).told().untold == 1.0
