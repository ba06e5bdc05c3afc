"""Offsets that wander or are every file's own."""

from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import waves
from calibration.balances.slowoffset import _line, offset_order, slow_columns, slowness, with_slow_offset
from calibration.names.scene import Scene
from tests.calibration.names.made import PERIOD_S, back_and_forth, drive

ROWS = 4000
X: np.ndarray = back_and_forth(40, 100)
T: np.ndarray = PERIOD_S * np.arange(ROWS)
TWO = np.repeat([0, 1], ROWS // 2)


def scene(y: np.ndarray | None = None, held: np.ndarray | None = None, **more: Any) -> Scene:
    base = np.column_stack([np.ones(ROWS), np.sign(np.gradient(X))])
    held = T > 30 if held is None else held
    return drive(X, base=base, y=np.zeros(ROWS) if y is None else y, held=held, dynamic=True, **more)


def test_fitted_and_held_rows_of_a_file_have_cosines_of_their_own() -> None:
    """Four half periods in the whole file, three quarters of which are fitted: three, and one."""
    held = T > 30
    found = slow_columns(scene().view, held, 4)
    assert found.shape == (ROWS, 4 + 2)
    begin, length = 0.0, T[~held][-1]
    for j in range(4):
        expected = np.where(held, 0.0, np.cos(np.pi * j * (T - begin) / length))
        assert found[:, j] == pytest.approx(expected)
    begin, length = T[held][0], T[-1] - T[held][0]
    assert found[:, 5] == pytest.approx(np.where(held, np.cos(np.pi * (T - begin) / length), 0.0))
    means = slow_columns(scene(files=TWO).view, TWO == 1, 0)
    assert np.array_equal(means, np.column_stack([TWO == 0, TWO == 1]).astype(float))
    short = slow_columns(scene().view, T > 38, 4)
    assert short.shape == (ROWS, 5 + 2)  # one cosine at least


def test_a_wandering_offset_stands_beside_the_one_that_is_declared() -> None:
    s = scene()
    assert with_slow_offset(s.problem, s.view, None) is s.problem
    p = with_slow_offset(s.problem, s.view, 4)
    assert p.base.shape == (ROWS, 2 + 5) and p.base_labels[2:] == [("slow_offset", "N")] * 5
    assert p.fresh is not None and p.fresh.shape == (ROWS, 6)
    two = scene(files=TWO, held=TWO == 1)
    own = with_slow_offset(two.problem, two.view, 0)
    assert own.base.shape == (ROWS, 3) and np.array_equal(own.base[:, 2], (TWO == 1).astype(float))
    two.problem.fresh = np.ones((ROWS, 1))
    again = with_slow_offset(two.problem, two.view, 0)
    assert again.fresh is not None and again.fresh.shape == (ROWS, 3)
    assert again.base.shape == (ROWS, 3)


def test_no_half_period_is_shorter_than_two_moves() -> None:
    s = scene()
    assert slowness(s.view) == 12  # of 39 reversals at most a dozen
    few = scene(files=np.repeat([0, 1], [3450, 550]))
    assert slowness(few.view) == 2  # of five
    few.view.direction = 0.4 * few.view.direction
    assert slowness(few.view) == 0
    few.view.direction = np.where(np.arange(ROWS) % 100 < 10, 0.0, few.view.direction / 0.4)
    assert slowness(few.view) == 2


def order(y: np.ndarray, flexible: np.ndarray | None = None, **more: Any) -> tuple[int | None, float]:
    s = scene(y + 0.01 * np.random.default_rng(1).standard_normal(ROWS), **more)
    return offset_order(s.view, s.problem, np.zeros((ROWS, 0)) if flexible is None else flexible)


def walk() -> np.ndarray:
    rng = np.random.default_rng(4)
    knots = np.cumsum(rng.standard_normal(9))
    return np.asarray(np.interp(T, np.linspace(0, 40, 9), knots))


def test_a_walk_needs_slow_functions_and_nothing_needs_none() -> None:
    assert order(walk())[0] == 12 and order(np.zeros(ROWS))[0] is None
    assert order(walk())[1] > 0.3 and order(np.zeros(ROWS))[1] == 0.0
    s = scene(walk())
    s.view.dynamic = False
    assert offset_order(s.view, s.problem, np.zeros((ROWS, 0)))[0] is None


def test_a_constant_per_file_is_no_walk() -> None:
    found, size = order(2.0 * (TWO == 1), files=TWO, held=TWO == 1)
    assert found == 0 and size == pytest.approx(2.0, rel=0.01)


def test_what_a_drive_may_leave_is_no_walk() -> None:
    y = np.sin(2 * np.pi * T / 13)
    assert order(y, waves(2 * np.pi * T / 13, (1,)))[0] is None


def test_a_slow_line_is_no_walk() -> None:
    y = np.cos(2 * np.pi * T / 13)
    assert order(y)[0] is None
    s = scene(y)
    assert _line(s.view, s.problem, 12) < 0.05


def test_few_rows_tell_no_offset() -> None:
    s = scene(walk(), held=T > 38)
    assert offset_order(s.view, s.problem, np.zeros((ROWS, 0)))[0] is None  # 200 rows for 13 columns
    s = scene(walk())
    assert offset_order(s.view, s.problem, np.zeros((ROWS, 200)))[0] is None
