"""The lags that make gusts: von Karman's spectrum by their formula, and one step of them by hand."""

from math import exp, sqrt

import numpy as np
import pytest

from plant.effects import signals as sig
from plant.effects.wind_torque import FAST, MIDDLE, OF_FAST, OF_MIDDLE, OF_SLOW, SLOW, formula, update

TAU_S, STEP_S = 2.0, 0.0005
TIMES = (SLOW, MIDDLE, FAST)
SHARES = (OF_SLOW, OF_MIDDLE, OF_FAST)


def test_three_lags_of_white_noise_have_von_karmans_spectrum() -> None:
    """White noise of density 4 tau through sum w / (1 + i x T), x = 2 pi f tau: 0.35 dB are 8.4 %."""
    x = np.logspace(-3, np.log10(300), 400)
    made = abs(sum(w / (1 + 1j * x * t) for w, t in zip(SHARES, TIMES, strict=True))) ** 2
    karman = (1 + 70.8 * (x / (2 * np.pi)) ** 2) ** (-5 / 6)
    assert np.abs(10 * np.log10(made / karman)).max() <= 0.36


def test_their_variance_is_one() -> None:
    """Lags of one noise of density 4 tau, one-sided, have the covariance 2 tau / (T1 + T2)."""
    lags = list(zip(SHARES, TIMES, strict=True))
    assert sum(2 * w * v / (t + u) for w, t in lags for v, u in lags) == pytest.approx(1.0, abs=0.02)


def test_the_torque_is_mean_and_deviation_times_the_sum() -> None:
    x = np.zeros(sig.MEMORY)
    assert formula(x, 0.0, 0.0, 0.0, 10.0, 5.0) == 10.0
    for place, share in enumerate(SHARES):
        lags = [0.0, 0.0, 0.0]
        lags[place] = 2.0
        assert formula(x, *lags, 10.0, 5.0) == pytest.approx(10.0 + 5.0 * 2.0 * share)


def step(time_s: float, lags: tuple[float, float, float], seed: float = 3.0) -> tuple[float, float, float]:
    x = np.zeros(sig.MEMORY)
    x[sig.TIME] = time_s
    with np.errstate(over="ignore"):  # of the random numbers' whole arithmetic, as Python
        return update(x, STEP_S, *lags, seed, TAU_S)


def test_a_step_of_each_lag_is_an_exponentials() -> None:
    """What was there decays, what comes has the density 4 tau: a variance of 2 tau / step."""
    after = np.array([step(k * STEP_S, (1e3, 2e3, 3e3)) for k in range(4000)])
    fresh = np.array([step(k * STEP_S, (0.0, 0.0, 0.0)) for k in range(4000)])
    for place, (before, time) in enumerate(zip((1e3, 2e3, 3e3), TIMES, strict=True)):
        kept = exp(-STEP_S / (time * TAU_S))
        assert after[:, place] - fresh[:, place] == pytest.approx(before * kept, rel=1e-9)
        spread = (1 - kept) * sqrt(2 * TAU_S / STEP_S)
        assert fresh[:, place].std() == pytest.approx(spread, rel=0.05)  # of 4000: 1.1 %
        assert abs(fresh[:, place].mean()) < 0.08 * spread  # 1.6 % of 4000
    assert abs(np.corrcoef(fresh[1:, 0], fresh[:-1, 0])[0, 1]) < 0.08


def test_noise_is_that_of_a_microsecond_and_of_the_seed() -> None:
    none = (0.0, 0.0, 0.0)
    assert step(1.0000001, none) == step(1.0000009, none)
    assert step(1.0000001, none) != step(1.0000011, none)
    assert step(1.0, none) != step(1.0, none, seed=4.0)
