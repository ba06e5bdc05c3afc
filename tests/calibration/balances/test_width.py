"""How wide the low pass is: by the position's noise, and by the quickest declared wave."""

from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import gaussian_filter1d

from calibration.balances.width import NARROW, USUAL, Limits, passing_waves, told_by_noise
from calibration.inputs.declaration import Column, Response, Rig, Stage

ROWS = 40_000
ONE = np.zeros(ROWS, dtype=np.int64)


def moved(period: float, rows: int = ROWS) -> np.ndarray:
    return np.asarray(np.sin(2 * np.pi * np.arange(rows) / period))


def rig(*stages: Stage) -> Rig:
    return Rig("made", Path("made.yaml"), {"position": Column("m")}, (Response("force", "N"),), stages)


def by_hand(x: np.ndarray, noise: float, limits: Limits) -> float:
    """Least times powers of 1.25, the first whose noise in a second difference is a small part of it."""
    for k in range(40):
        sigma = limits.least * 1.25**k
        bent = noise * np.sqrt(3 / (8 * np.sqrt(np.pi) * sigma**5))
        a = np.diff(gaussian_filter1d(x, sigma), 2)
        a = np.clip(a, *np.quantile(a, [0.005, 0.995]))
        part = limits.noise if len(x) > 600 * sigma else 0.03
        if sigma >= 40.0 or bent < part * np.sqrt(np.mean(a**2)):
            return float(sigma)
    raise AssertionError


@pytest.mark.parametrize("noise", [1e-9, 1e-7, 1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("limits", [USUAL, NARROW])
def test_the_filter_widens_by_quarters_until_noise_is_a_small_part(noise: float, limits: Limits) -> None:
    x = moved(1500.0)
    found = told_by_noise(x, ONE, noise, limits)
    assert found == pytest.approx(by_hand(x, noise, limits))


@pytest.mark.parametrize("rows", [1200, 1201, 4000, 12_000])
def test_of_few_rows_a_filter_may_leave_three_times_the_noise(rows: int) -> None:
    x = moved(300.0, rows)
    for noise in np.geomspace(1e-7, 1e-4, 13):
        found = told_by_noise(x, ONE[:rows], float(noise))
        assert found == pytest.approx(by_hand(x, float(noise), USUAL))


def test_no_file_s_end_is_filtered_over() -> None:
    x = moved(1500.0)
    file = np.repeat([0, 1], ROWS // 2)
    leapt = x + 1e6 * file
    assert told_by_noise(leapt, file, 1e-6) == told_by_noise(x, ONE, 1e-6)


def test_the_numbers_are_those_that_stand_beside_them() -> None:
    assert USUAL == (0.01, 2.0) and NARROW == (0.03, 1.0)
    assert 40.0 <= told_by_noise(moved(1500.0), ONE, 1.0) < 40.0 * 1.25


@pytest.mark.parametrize(("harmonics", "period"), [(1, 0.5), (4, 0.5), (8, 2.0)])
def test_the_quickest_declared_wave_keeps_six_tenths_at_the_top_speed(harmonics: int, period: float) -> None:
    """exp(-(2 pi c s)^2 / 2) = exp(-1/2) = 0.61 at c cycles per row: s = 1 / (2 pi c)."""
    speed = 0.01  # per row
    x = speed * np.arange(2000.0)
    quick = Stage("worm", period, None, harmonics, None)
    slow = Stage("axis", 10 * period, None, 1, None)
    sigma = passing_waves(x, ONE[:2000], rig(slow, quick), 2.0, 0.1)
    cycles = speed * harmonics / period
    assert sigma == pytest.approx(1 / (2 * np.pi * cycles), rel=1e-3)
    assert passing_waves(x, ONE[:2000], rig(slow, quick), 2.0, 100.0) == 100.0


def test_no_wave_is_quicker_than_half_a_cycle_per_row_and_without_one_all_filters_pass() -> None:
    x, one = 0.01 * np.arange(2000.0), ONE[:2000]
    assert passing_waves(x, one, rig(Stage("a", 1e-4, None, 1, None)), 2.0, 0.1) == pytest.approx(1 / np.pi)
    assert passing_waves(x, one, rig(), 2.0, 0.1) == np.inf
    assert passing_waves(x, one, rig(Stage("a", None, 3.0, 9, None)), 2.0, 0.1) == np.inf
    assert passing_waves(0 * x, one, rig(Stage("a", 1.0, None, 1, None)), 2.0, 0.1) == np.inf


def test_the_top_speed_is_that_of_the_quickest_twentieth_of_all_files() -> None:
    """Ninety of a hundred rows at 0.001, ten at 0.01; a file of one row has no rate."""
    x = np.cumsum(np.repeat([0.001, 0.01], [1800, 200]))
    file = np.repeat([0, 1], [2000, 1])
    found = passing_waves(np.append(x, 5.0), file, rig(Stage("a", 1.0, None, 1, None)), 2.0, 0.1)
    assert found == pytest.approx(1 / (2 * np.pi * 0.01), rel=1e-3)
    slow = np.cumsum(np.repeat([0.001, 0.01], [1940, 60]))
    found = passing_waves(slow, ONE[:2000], rig(Stage("a", 1.0, None, 1, None)), 2.0, 0.1)
    assert found == pytest.approx(1 / (2 * np.pi * 0.001), rel=1e-3)
