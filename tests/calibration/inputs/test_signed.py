"""Words: numbers of both signs that were written unsigned come back in every run, whatever a run holds."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.inputs.counters import word_length


@settings(max_examples=50, deadline=None)
@given(
    bits=st.sampled_from([16, 24, 32]),
    low=st.integers(-8000, -5),
    high=st.integers(0, 8000),
    seed=st.integers(0, 1000),
)
def test_numbers_of_both_signs_show_their_word(bits: int, low: int, high: int, seed: int) -> None:
    x = np.random.default_rng(seed).integers(low, high + 1, 200).astype(float)
    x[:4] = low, low + 1, low + 2, high
    assert word_length(x % 2.0**bits) == 2.0**bits
    assert word_length(x) == 0.0  # it has its sign already


@pytest.mark.parametrize(
    "x",
    [
        np.arange(0.0, 65536.0, 50.0),  # a converter that is used from end to end
        np.concatenate([np.arange(100.0), np.full(3, 65535.0)]),  # readings that failed
        np.arange(1000.0),
        np.concatenate([np.arange(100.0), 2.0**48 - np.arange(1.0, 101.0)]),  # longer than any word
        np.linspace(0.0, 65535.0, 100) + 0.25,  # no whole numbers
        np.concatenate([np.arange(100.0), np.arange(65436.0, 65536.0)]) + 0.25,  # likewise, at both ends
        np.array([1.0, 65535.0, 65534.0, 65533.0]),  # too few rows
        np.concatenate([np.arange(200.0, 900.0), np.arange(6000.0, 7500.0)]),  # mA, idle and running
        np.concatenate([np.arange(0.0, 10.0), np.arange(180.0, 200.0)] * 3),  # a duty of 8 bits
        np.concatenate([np.zeros(50), np.arange(23900.0, 24100.0)]),  # mV, off and on
        np.concatenate([np.arange(9000.0, 9100.0), np.arange(56000.0, 56100.0)]),  # far off zero
    ],
)
def test_what_is_no_signed_word_is_left(x: np.ndarray) -> None:
    assert word_length(x) == 0.0


@pytest.mark.parametrize("scale", [0.1, 0.01, 0.001, 0.3])
def test_a_scale_there_and_back_leaves_whole_numbers(scale: float) -> None:
    x = np.random.default_rng(3).integers(-700, 700, 500).astype(float) % 65536
    assert word_length(x * scale / scale) == 65536.0
