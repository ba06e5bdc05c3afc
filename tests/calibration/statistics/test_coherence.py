"""What goes on in time beyond the filter's reach, and what the filter alone makes of noise."""

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from calibration.decide.thresholds import LEAST_SHARE
from calibration.statistics.whitening import APART, coherence

ROWS, SIGMA = 4000, 3.0
FIRST = int(np.ceil(APART * SIGMA))
ALL = np.ones(ROWS, dtype=bool)
ONE = np.zeros(ROWS, dtype=np.int64)
TIME = np.arange(ROWS)


@pytest.mark.parametrize("seed", range(30))
def test_filtered_noise_is_no_function_of_time(seed: int) -> None:
    noise = gaussian_filter1d(np.random.default_rng(seed).standard_normal(ROWS), SIGMA)
    assert coherence(noise, ALL, ONE, FIRST) < LEAST_SHARE


def test_a_swept_line_and_a_switch_that_sticks_are() -> None:
    rng = np.random.default_rng(0)
    swept = np.sin(2 * np.pi * (0.01 * TIME + 2e-6 * TIME**2))
    telegraph = np.sign(np.sin(np.cumsum(rng.exponential(0.02, ROWS))))
    for signal in (swept, telegraph):
        assert coherence(signal + 0.3 * rng.standard_normal(ROWS), ALL, ONE, FIRST) > 2 * LEAST_SHARE


def test_sessions_are_not_compared_with_each_other_and_few_rows_say_nothing() -> None:
    signal = np.sin(2 * np.pi * 0.01 * TIME)
    assert coherence(signal, ALL, TIME // (FIRST - 1), FIRST) == 0.0
    assert coherence(signal, TIME < 100, ONE, FIRST) == 0.0
