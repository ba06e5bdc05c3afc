"""The low pass of a balance, and the terms that go through it."""

import numpy as np
import pytest

from calibration.balances.filters import Filter, by_piece, pieces
from calibration.balances.frame import Frame
from calibration.balances.motion import motion_of
from calibration.inputs.rigfile import telescope

ROWS, PERIOD_S = 60_000, 0.01
ONE = np.zeros(ROWS, dtype=np.int64)


@pytest.mark.parametrize("low_pass", [Filter(3.0), Filter(8.0), Filter(1.0, 3), Filter(1.0, 5)])
def test_a_filter_knows_what_it_passes_of_white_noise(low_pass: Filter) -> None:
    behind = low_pass(np.random.default_rng(1).standard_normal(ROWS), ONE)
    assert np.mean(behind**2) == pytest.approx(
        low_pass.passes, rel=0.12
    )  # 60 000 rows hold 2 000 that know nothing of each other


@pytest.mark.parametrize("sigma", [3.0, 5.0])
def test_a_filter_knows_what_it_passes_of_second_differences(sigma: float) -> None:
    low_pass = Filter(sigma)
    bent = np.diff(low_pass(np.random.default_rng(2).standard_normal(ROWS), ONE), 2)
    assert np.mean(bent**2) == pytest.approx(low_pass.bends, rel=0.2)


def test_no_filter_reaches_over_the_end_of_a_segment() -> None:
    label = np.repeat([0, 1], 100)
    step = label.astype(float)
    assert np.array_equal(Filter(5.0)(step, label), step)
    assert np.array_equal(Filter(0.0)(step, label), step)
    assert pieces(label) == [(0, 100), (100, 200)] and pieces(label[:0]) == []


def test_stretches_that_are_too_short_are_zero() -> None:
    label = np.array([0, 0, 1, 2, 2, 2])
    assert by_piece(np.ones(6), label, np.cumsum, 2).tolist() == [1.0, 2.0, 0.0, 1.0, 2.0, 3.0]


def logged(position: np.ndarray) -> Frame:
    """One run, of a position alone."""
    n = len(position)
    zero = np.zeros(n, dtype=np.int64)
    return Frame(
        runs=[],
        period_s=PERIOD_S,
        t=PERIOD_S * np.arange(n),
        clock=np.zeros(n),
        run=zero,
        session=zero,
        columns={"position": position},
        scale={},
        rig=telescope("ra"),
    )


def test_terms_of_two_motors_stand_one_after_the_other_on_the_motions_grid() -> None:
    m = motion_of(logged(np.linspace(0.0, 1.0, 3000)), 3)
    rows = len(m.rows)
    both, held = np.ones(2 * rows), np.arange(3000) > 2000
    terms = [("scale", "V", both), ("offset", "V", np.zeros((2 * rows, 2)))]
    p = m.problem(held, terms, channel="E", unit="V", y=both, valid=both > 0)
    assert p.base_labels == [("scale", "V"), ("offset", "V"), ("offset", "V")]
    assert p.t.tolist() == [*m.frame.t[m.rows], *m.frame.t[m.rows]]
    assert p.held.sum() == 2 * held[m.rows].sum() and p.period_s == pytest.approx(3 * PERIOD_S)
    p.add(("slope", "V/s", p.t))
    assert p.base.shape == (2 * rows, 4) and p.place("slope") == 3
    numbers, residual = p.plain_fit(p.train)
    assert numbers["scale"] == pytest.approx(1.0) and np.abs(residual).max() < 1e-9


def test_a_column_that_no_run_has_is_zero_and_a_gap_is_bridged_as_far_as_it_is_short() -> None:
    position = np.linspace(0.0, 1.0, 300)
    position[100:102] = position[200:220] = np.nan
    frame = logged(position)
    filled, trusted = frame.filled("position")
    assert filled == pytest.approx(np.linspace(0.0, 1.0, 300))
    assert trusted[100:102].all() and not trusted[200:220].any()
    supply, known = frame.filled("supply")
    assert not supply.any() and known.all()


def test_rows_beside_a_marked_one_are_not_clear() -> None:
    m = motion_of(logged(np.linspace(0.0, 1.0, 300)), 3)
    marked, none = np.zeros(300, dtype=bool), np.zeros(300, dtype=bool)
    marked[100] = True
    assert m.rows[~m.clear(marked, none)].tolist() == [100]
    marked[101] = True
    assert m.rows[~m.clear(marked)].tolist() == [100, 103]
