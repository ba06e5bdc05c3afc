"""An unnamed function that stood for a name until that was found stays only for what the name leaves."""

import numpy as np
import pytest

from calibration.candidates.candidate import Candidate
from calibration.candidates.unknown import spline_columns
from calibration.channels.problem import Problem
from calibration.decide.heldout import HeldOut
from calibration.decide.judge import Refusal, design
from calibration.decide.scan import Contender, fit_with
from calibration.decide.superfluous import drop_needless

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
        "T",
        "N m",
        y,
        speed[:, None],
        [("viscous", "N m s/rad")],
        t,
        run,
        np.zeros(ROWS, dtype=np.int64),
        valid,
        run == 3,
        PERIOD_S,
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
    picks: list[Contender] = []
    for c in (unnamed, load):
        fitted = fit_with(p, design(p, [x.candidate for x in picks]), c)
        assert fitted is not None
        picks.append(fitted)
    refused: list[Refusal] = []
    drop_needless(p, picks, [[], []], [HeldOut(1, 1, 0, 0)] * 2, 0.05, refused)
    assert ("unknown" in [x.candidate.name for x in picks]) == stays
    assert bool(refused) != stays
    assert picks[-1].candidate.name == "gravity_imbalance"
