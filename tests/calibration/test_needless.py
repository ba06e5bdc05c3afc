"""An unnamed function that stood for a name until that was found stays only for what the name leaves."""

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide.rules import leave_out, needless
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.names.unknown_shapes import spline_columns

PERIOD_S, ROWS = 0.03, 8000
NOISE, GRAVITY = 0.5, 30.0  # N m
ARC = 0.8  # rad that the axis sees: the load is nearly steady there, as any smooth function may be


@pytest.mark.parametrize(("size", "stays"), [(0.15, False), (2.0, True)])
def test_an_unnamed_function_beside_the_name_it_stood_for(size: float, stays: bool) -> None:
    """`size`, N m: what is in truth a function of the speed; below noise/3 it takes less than it must."""
    rng = np.random.default_rng(7)
    t = PERIOD_S * np.arange(ROWS)
    angle = ARC / 2 * np.sin(2 * np.pi * t / 40.0) + 0.1 * np.sin(2 * np.pi * t / 17.0)
    speed = np.gradient(angle, PERIOD_S)
    w = speed / np.abs(speed).max()
    y = GRAVITY * np.cos(angle + 0.2) + size * np.cos(3 * w) + NOISE * rng.standard_normal(ROWS)
    run = np.repeat(np.arange(4), ROWS // 4)
    valid = np.ones(ROWS, dtype=bool)
    p = Problem(
        channel="T",
        unit="N m",
        y=y,
        base=speed[:, None],
        base_labels=[("viscous", "N m s/rad")],
        t=t,
        run=run,
        session=np.zeros(ROWS, dtype=np.int64),
        valid=valid,
        held=run == 3,
        period_s=PERIOD_S,
    )
    knots = spline_columns(w, 9)
    labels = tuple((f"knot_{k}", "N m") for k in range(knots.shape[1]))
    unnamed = Candidate("unknown", "velocity", knots, labels)
    load = Candidate(
        "gravity_imbalance",
        "axis_angle",
        np.column_stack([np.cos(angle), np.sin(angle)]),
        (("amplitude", "N m"),),
        kind="line",
    )
    picks = Selection.of(p)
    for c in (unnamed, load):
        fitted = fit_with(p, picks.columns, c)
        assert fitted is not None
        picks = picks.keep([*picks.chosen, fitted])
    s = leave_out(picks, needless(0.05))
    assert ("unknown" in [c.name for c in s.candidates]) == stays
    assert bool(s.refused) != stays
    assert s.candidates[-1].name == "gravity_imbalance"
