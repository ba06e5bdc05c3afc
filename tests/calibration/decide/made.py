"""Channels of residual that are made up, for the rules of the selection."""

import numpy as np

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem

PERIOD_S = 0.05


def problem(y: np.ndarray, base: np.ndarray | None = None, runs: int = 4, held: int | None = None) -> Problem:
    """`y` (n,) in N m over equal runs, of which the last one, or `held`, is held out."""
    n = len(y)
    run = np.repeat(np.arange(runs), -(-n // runs))[:n]
    base = np.ones((n, 1)) if base is None else base
    return Problem(
        channel="T",
        unit="N m",
        y=y,
        base=base,
        base_labels=[(f"term_{k}", "N m") for k in range(base.shape[1])],
        t=PERIOD_S * np.arange(n),
        run=run,
        session=np.zeros(n, dtype=np.int64),
        valid=np.ones(n, dtype=bool),
        held=run == (runs - 1 if held is None else held),
        period_s=PERIOD_S,
        block_s=1.0,
        ar_order=2,
    )


def term(name: str, columns: np.ndarray, **more: object) -> Candidate:
    """A candidate with one label per column."""
    labels = tuple((f"size_{k}", "N m") for k in range(columns.shape[1]))
    return Candidate(name, "time", columns, labels, **more)  # type: ignore[arg-type]


def line(name: str, turns: np.ndarray, order: float, **more: object) -> Candidate:
    """A sine pair over `turns` (n,)."""
    x = 2 * np.pi * order * turns
    columns = np.column_stack([np.cos(x), np.sin(x)])
    labels = (("amplitude", "N m"),)
    return Candidate(name, "axis_angle", columns, labels, kind="line", order=order, **more)  # type: ignore[arg-type]
