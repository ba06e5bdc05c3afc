"""The torque of wind against von Karman's formulas; spectrum by Welch, correlation by its Bessel function."""

import numpy as np
import pytest
from scipy.signal import welch
from scipy.special import gamma, kv

from plant.effects import signals as sig
from plant.evaluate import evaluate, signals
from plant.parts import EffectModel, Number
from plant.plant import Plant
from plant.wind import INTENSITY, LEE, share, wind
from plant.wind import torque as torque_of
from tests.plant.bench import SECOND, with_effect

STEP_S = 0.0005  # the plant's grid
TAU = 0.5


def torque(seconds: float, seed: float = 7.0, step_s: float = STEP_S, tau: float = TAU) -> np.ndarray:
    rows = signals(round(seconds / step_s), {})
    rows[:, sig.TIME] = (np.arange(len(rows)) + 0.5) * step_s
    return evaluate(
        "wind_torque", rows, {"mean": 10.0, "deviation": 5.0, "correlation_time": tau, "seed": seed}
    )


def karman(f: np.ndarray, tau: float) -> np.ndarray:
    """Longitudinal spectrum of unit variance, 1/Hz, one-sided; e.g. ESDU 85020 or MIL-F-8785C."""
    return 4 * tau / (1 + (1.339 * 2 * np.pi * f * tau) ** 2) ** (5 / 6)


def test_the_spectrum_is_von_karmans() -> None:
    made = torque(2400.0, step_s=0.002)
    f, density = welch(made, 500.0, nperseg=1 << 13)
    for low, high in ((0.1, 0.5), (0.5, 1.0), (1.0, 2.0), (2.0, 4.0), (4.0, 8.0), (8.0, 20.0), (20.0, 60.0)):
        band = (f >= low) & (f < high)
        # 0.35 dB of the lags, 8 %, and the chance of 146 segments
        assert density[band].sum() == pytest.approx(25.0 * karman(f[band], TAU).sum(), rel=0.12), (low, high)


def test_mean_variance_and_correlation_are_the_declared_ones() -> None:
    made = torque(4000.0, step_s=0.005)
    assert made.mean() == pytest.approx(10.0, abs=0.3)
    assert made.std() == pytest.approx(5.0, rel=0.05)
    left = made - made.mean()
    for lag_s in (0.1, 0.5, 1.0):
        u = lag_s / (1.339 * TAU)
        formula = 2 ** (2 / 3) / gamma(1 / 3) * u ** (1 / 3) * kv(1 / 3, u)
        lag = round(lag_s / 0.005)
        assert (left[:-lag] * left[lag:]).mean() / left.var() == pytest.approx(formula, abs=0.06)


def test_it_is_the_seeds_and_the_times() -> None:
    assert np.array_equal(torque(1.0), torque(1.0))
    assert not np.array_equal(torque(1.0), torque(1.0, seed=8.0))
    model = with_effect(EffectModel("wind_torque", parameters={"mean": Number(10.0, "N m", "a test")}))
    once, often = Plant(model, 3), Plant(model, 3)
    once.advance(SECOND)
    for k in range(1, 101):
        often.advance(k * SECOND // 100)
    assert np.array_equal(once.world, often.world)


def test_the_torque_goes_with_the_square_of_the_speed() -> None:
    mean, deviation, time = torque_of(10.0)
    assert mean == pytest.approx(0.5 * 1.0 * 100.0 * 1.0 * 1.2 * 0.33)  # dynamic pressure, area, arm
    assert deviation / mean == pytest.approx(2 * INTENSITY)  # of a square, first order (Davenport 1961)
    assert time == pytest.approx(0.1)  # an eddy of a metre passes
    assert torque_of(20.0)[0] == pytest.approx(4 * mean)
    squares = (10.0 * (1 + INTENSITY * np.random.default_rng(1).standard_normal(100_000))) ** 2
    assert deviation / mean == pytest.approx(squares.std() / 100.0, rel=0.03)
    assert torque_of(0.0)[:2] == (0.0, 0.0)


def test_the_dome_keeps_off_more_the_farther_the_slit_looks_away() -> None:
    shares = [share(np.radians(angle), 1.0) for angle in range(0, 181, 5)]
    assert shares[0] == 1.0 and shares[-1] == LEE and sorted(shares, reverse=True) == shares
    assert len(set(shares[:17])) == 17  # to 80 deg it falls
    assert share(np.radians(-40), 1.0) == pytest.approx(share(np.radians(400), 1.0))
    assert share(0.0, 0.0) == 0.0 and share(0.0, 0.5) == 0.5


def test_a_wind_in_the_slit_is_an_effect_with_its_numbers() -> None:
    """5 m/s: 0.5 * 25 * 1.2 * 0.33 of mean, two fifths of it, and a metre passes in a fifth of a second."""
    made = wind(5.0)
    assert made.name == "wind_torque" and made.enabled and made.stage is None
    found = {name: (number.value, number.unit) for name, number in made.parameters.items()}
    assert found["mean"] == (pytest.approx(4.95), "N m")
    assert found["deviation"] == (pytest.approx(1.98), "N m")
    assert found["correlation_time"] == (pytest.approx(0.2), "s")
    assert {number.source for number in made.parameters.values()} == {
        "wind of 5 m/s in the slit, plant/wind.py"
    }


def test_a_calm_has_eddies_of_a_hundred_seconds() -> None:
    assert torque_of(0.0) == (0.0, 0.0, pytest.approx(100.0)) and torque_of(0.02)[2] == pytest.approx(50.0)


def test_a_slit_lets_in_what_its_width_shows() -> None:
    assert share(np.radians(60.0), 0.5) == pytest.approx(0.25)
    assert share(np.radians(89.0), 1.0) == share(np.pi, 1.0) == 0.1
