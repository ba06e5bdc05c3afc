"""What is drawn without a picture of it: figures as they are, and selections whose numbers are given."""

from typing import Any

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide.heldout import HeldOut
from calibration.decide.scan import Contender
from calibration.decide.selection import NO_SCORES, Selection
from calibration.statistics.regression import Fit
from calibration.statistics.surrogate import Scores
from calibration.statistics.whitening import Whitener

PERIOD_S = 0.5


def problem(y: np.ndarray, held: int = 0, **more: Any) -> Problem:
    """One run without declared terms, of which the last `held` rows are held out."""
    n = len(y)
    given: dict[str, Any] = {
        "channel": "T", "unit": "N m", "y": y, "base": np.zeros((n, 0)), "base_labels": [],
        "t": PERIOD_S * np.arange(n), "run": np.zeros(n, dtype=np.int64),
        "session": np.zeros(n, dtype=np.int64),
        "valid": np.ones(n, dtype=bool), "held": np.arange(n) >= n - held, "period_s": PERIOD_S,
    }  # fmt: skip
    return Problem(**(given | more))


def fit(residual: np.ndarray, *beta: float) -> Fit:
    """Coefficients and what they leave, as they are given."""
    return Fit(np.array(beta), np.eye(len(beta)), residual, Whitener(np.zeros(0)), 1.0, 0.0, len(residual))


def selection(p: Problem, *chosen: Candidate, **more: Any) -> Selection:
    """Every effect with the coefficient 2; before, y is left, and after it nothing."""
    after = fit(np.zeros(len(p.y)), *[2.0] * sum(c.width for c in chosen))
    none: dict[str, Any] = dict.fromkeys(("wald", "bayes", "gain"), 0.0) | {"blocks": 1.0, "effect": 1.0}
    made = [Contender(candidate=c, fit=after, at=slice(0, 1), **none) for c in chosen]
    given: dict[str, Any] = {
        "before": fit(p.y),
        "after": after,
        "held": HeldOut(),
        "chosen": made,
        "scores": NO_SCORES,
    } | more
    return Selection(problem=p, **given)


def effect(column: np.ndarray, name: str = "drag", **more: Any) -> Candidate:
    """One column in the channel's unit."""
    return Candidate(name, "time", column[:, None], (("size", "N m"),), **more)


def scores(value: list[float], threshold: float, surrogates: list[float]) -> Scores:
    """Of the log and of its surrogates."""
    return Scores(np.array(value), threshold, np.array(surrogates))


def legend(ax: Any) -> list[str]:
    """Words of it."""
    return [text.get_text() for text in ax.get_legend().get_texts()]
