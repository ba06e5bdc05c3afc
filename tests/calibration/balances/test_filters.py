"""The low pass of a balance."""

import numpy as np
import pytest

from calibration.balances.filters import Filter

ROWS = 4000
INNER = slice(200, -200)


@pytest.mark.parametrize("low_pass", [Filter(0.0), Filter(1.0), Filter(3.5), Filter(1.0, 3), Filter(1.0, 7)])
@pytest.mark.parametrize("share", [0.0, 0.1, 0.5, 0.85])
def test_a_filter_leaves_its_gain_of_a_sine(low_pass: Filter, share: float) -> None:
    cycles = share / max(low_pass.boxcar, 2 * np.pi * low_pass.sigma, 2.0)
    sine = np.cos(2 * np.pi * cycles * np.arange(ROWS))
    behind = low_pass(sine, np.zeros(ROWS, dtype=np.int64))
    assert behind[INNER] == pytest.approx(low_pass.gain(cycles) * sine[INNER], abs=2e-4)
    assert low_pass.gain(-cycles) == low_pass.gain(cycles)


def test_boxcars_show_nothing_beyond_their_first_zero() -> None:
    gain = Filter(1.0, 3).gain(np.array([0.0, 0.29, 0.31, 0.6]))
    assert gain[0] == 1.0
    assert gain[1] > 0.0
    assert list(gain[2:]) == [0.0, 0.0]
