"""Scores that let a contender in, and those that do not."""

import re
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.decide.accept import needed, refuse
from calibration.decide.heldout import HeldOut
from calibration.decide.thresholds import LUCK_Z, MARGIN, ROUNDING

TRIED = 1000
GOOD = HeldOut(before=2.0, after=1.0, z=9.0, share=0.5, everywhere=True)


def contender(**other: Any) -> Any:
    """One that has all it takes."""
    candidate = SimpleNamespace(name="gear_mesh", least=None, kind="linear", stage=None)
    return SimpleNamespace(
        **{"bayes": 50.0, "evidence": 30.0, "candidate": candidate, "after": lambda k: 30.0 * k, **other}
    )


def scored(share: float, z: float = 9.0, everywhere: bool = False) -> HeldOut:
    return HeldOut(before=1.0, after=(1.0 - share) ** 0.5, z=z, share=share, everywhere=everywhere)


@pytest.mark.parametrize("share", [0.5, 0.0, -0.9 * ROUNDING])
def test_an_effect_that_the_held_out_run_does_not_excite_may_gain_nothing(share: float) -> None:
    assert refuse(contender(), GOOD, scored(share), MARGIN, TRIED) == ""


@pytest.mark.parametrize("worse", [1.1 * ROUNDING, 0.05, 0.4, 0.6])
def test_none_may_make_the_held_out_run_worse(worse: float) -> None:
    assert refuse(contender(), GOOD, scored(-worse), MARGIN, TRIED) == (
        f"makes the held-out mean square worse by {100 * worse:.1f} %"
    )


@pytest.mark.parametrize(
    ("one", "inside", "why"),
    [
        (contender(bayes=0.0), GOOD, "costs|cost"),
        (contender(), HeldOut(), "too few rows"),
        (contender(), scored(0.9 * MARGIN, 3.0), "falls by 4.5 % only"),
        (contender(), scored(-0.2), r"grows by 20.0 %$"),
        (contender(), scored(0.5, 0.9 * LUCK_Z), "within luck"),
        (contender(evidence=0.9 * 7.0, after=lambda k: 0.0), GOOD, "too little evidence"),
        (contender(evidence=0.9 * 7.0, after=lambda k: 4.0 * k), GOOD, "2 times as long"),
    ],
)
def test_each_rule_says_why(one: Any, inside: HeldOut, why: str) -> None:
    assert re.search(why, refuse(one, inside, GOOD, MARGIN, TRIED))
    assert refuse(contender(), scored(0.5, 0.9 * LUCK_Z, everywhere=True), GOOD, MARGIN, TRIED) == ""


@pytest.mark.parametrize(
    ("apart", "share", "accepted"), [(True, 0.6, True), (False, 0.6, False), (True, 0.4, False)]
)
def test_rows_that_nothing_was_fitted_to_are_further_evidence(
    apart: bool, share: float, accepted: bool
) -> None:
    """One log in ten thousand by luck: by two standard errors there, 0.023 of those, too."""
    one = contender(evidence=needed(TRIED) + np.log10(0.0228) + 0.01, after=lambda k: 0.0)
    held = replace(scored(share), apart=apart)
    assert (refuse(one, GOOD, held, MARGIN, TRIED) == "") is accepted


def test_the_best_of_more_candidates_needs_more() -> None:
    """By luck in one log of ten thousand (Bonferroni): a thousand candidates need three decades more."""
    assert needed(1000) - needed(1) == pytest.approx(3.0)
    few = contender(evidence=5.0, after=lambda k: 0.0)
    assert refuse(few, GOOD, GOOD, MARGIN, 2) == "" != refuse(few, GOOD, GOOD, MARGIN, TRIED)
