"""Columns of a record: their step, their range, their gaps."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from calibration.inputs.run import Run, quantum, signal_of
from calibration.inputs.thresholds import GAP


@settings(max_examples=80, deadline=None)
@given(
    seed=st.integers(0, 2**32 - 1),
    step=st.floats(1e-6, 1e3),
    offset=st.floats(-100.0, 100.0),
    span=st.integers(5, 40),
)
def test_the_step_of_a_counted_column_is_found(seed: int, step: float, offset: float, span: int) -> None:
    counts = np.random.default_rng(seed).integers(0, span, 600)
    assume(abs(offset) < 1e4 * step)  # else doubles themselves blur the steps
    assert quantum(offset + step * counts) == pytest.approx(step, rel=1e-3)


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1))
def test_a_smooth_column_has_no_step(seed: int) -> None:
    assert quantum(np.random.default_rng(seed).standard_normal(500)) is None


@settings(max_examples=40, deadline=None)
@given(seed=st.integers(0, 2**32 - 1), digits=st.integers(0, 4))
def test_digits_of_a_text_file_are_a_step(seed: int, digits: int) -> None:
    x = np.round(np.random.default_rng(seed).standard_normal(3000), digits)
    assert quantum(x) == pytest.approx(10.0**-digits, rel=1e-3)


def test_few_values_tell_no_step() -> None:
    assert quantum(np.array([])) is None
    assert quantum(np.array([1.0, 1.0])) is None
    assert quantum(np.array([1.0, 2.0, 1.0])) is None


def test_a_signal_says_its_range_and_what_is_missing() -> None:
    s = signal_of("effort", "u", "N m", np.array([1.0, np.nan, 4.0, 2.0]), 3)
    assert (s.low, s.high, s.missing, s.wraps, s.unit) == (1.0, 4.0, 1, 3, "N m")
    assert s.quantum == pytest.approx(1.0)
    nothing = signal_of("effort", "u", "N m", np.full(3, np.nan), 0)
    assert np.isnan(nothing.low) and nothing.missing == 3 and nothing.quantum is None


def test_a_gap_is_longer_than_rows_that_shake_and_says_from_when_to_when() -> None:
    t = np.array([0.0, 1.0, 2.0, 2.0 + GAP * 0.99, 10.0, 11.0, 20.0])
    r = Run("a", Path("a"), "a", {"t": t}, period_s=1.0)
    assert r.gaps() == [(t[3], 10.0), (11.0, 20.0)]
    assert r.duration_s == 20.0
    assert r.rows == 7


def test_a_run_of_one_row_lasts_no_time() -> None:
    assert Run("e", Path("e"), "e", {"t": np.zeros(1)}).duration_s == 0.0
