"""The order of contenders: two that say the same are not told apart by their own covariances."""

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.decide.scan import Contender, ranked
from calibration.statistics.regression import Fit
from calibration.statistics.whitening import Whitener

ROWS = 1000
ONE, SIDES = np.ones((ROWS, 1)), np.repeat(np.eye(2), ROWS // 2, axis=0)


def contender(name: str, columns: np.ndarray, gain: float, bayes: float, kind: str = "linear") -> Contender:
    """One whose columns all have the size 1; `bayes` is what its own covariance made of its gain."""
    width = columns.shape[1]
    labels = tuple(("size", "1") for _ in range(width))
    candidate = Candidate(name, "time", columns, labels, kind=kind)
    zero = np.zeros(ROWS)
    fit = Fit(np.ones(width), np.eye(width), zero, Whitener(np.zeros(0)), 1.0, 0.0, ROWS)
    return Contender(
        candidate=candidate,
        fit=fit,
        wald=250.0,
        blocks=100.0,
        bayes=bayes,
        gain=gain,
        effect=1.0,
        at=slice(0, width),
    )


def test_the_simpler_of_two_that_say_the_same_goes_first() -> None:
    simple, rich = contender("simple", ONE, 500.0, 100.0), contender("rich", SIDES, 501.0, 300.0)
    assert [c.candidate.name for c in ranked([rich, simple])] == ["simple", "rich"]


def test_a_richer_one_that_gains_what_it_costs_stays_first() -> None:
    simple, rich = contender("simple", ONE, 500.0, 100.0), contender("rich", SIDES, 520.0, 300.0)
    assert [c.candidate.name for c in ranked([simple, rich])] == ["rich", "simple"]


def test_two_explanations_keep_the_order_of_their_evidence() -> None:
    other = np.cos(np.arange(ROWS))[:, None]
    first, second = contender("first", other, 400.0, 300.0), contender("second", ONE, 500.0, 200.0)
    assert [c.candidate.name for c in ranked([second, first])] == ["first", "second"]


def test_a_line_is_not_displaced_by_one_whose_order_was_searched() -> None:
    staged = contender("staged", SIDES, 500.0, 300.0, kind="line")
    free = contender("free", SIDES, 505.0, 200.0, kind="line")
    assert [c.candidate.name for c in ranked([free, staged])] == ["staged", "free"]
