"""The peers see what is put in front of them; the benchmark says so when one is missing."""

import sys

import numpy as np
import pytest

from plant.gears import ORDERS as STAGES
from plant.units import ARCSEC
from tests.benchmarks.drives import LEVELS, programme
from tests.benchmarks.peers import MissingPeer, Residual, rms, sindy, whole_vector


@pytest.fixture
def residual() -> Residual:
    """A static drive with gravity and shaft 1 on top, 1 N m of white noise; the last third is held out."""
    rng = np.random.default_rng(1002)
    rate = programme(600.0, rng)[::3] * ARCSEC
    t = 0.03 * np.arange(len(rate))
    angle = np.cumsum(rate) * 0.03
    added = 40.0 * np.sin(angle + 0.3) + 8.0 * np.sin(STAGES["shaft1"] * angle + 1.0)
    noise = rng.normal(0.0, 1.0, len(t))
    acceleration = np.gradient(rate, t)
    static = 230.0 * np.tanh(rate / 2e-5) + 6700.0 * rate
    test = t > 400.0
    none = np.zeros((len(t), 0))
    declared = (6700.0, 229.0, 621.0, 4e-4)
    torque = 1760.0 * acceleration + static + added + noise
    return Residual(t, angle, rate, acceleration, torque, added + noise, none, 1760.0, declared, ~test, test)


def test_programme_covers_every_level_both_ways() -> None:
    wanted = programme(120.0, np.random.default_rng(1003))
    assert len(wanted) == 12000
    for level, _ in LEVELS[:-1]:
        for sign in (1, -1):
            assert np.any((sign * wanted >= 0.8 * level) & (sign * wanted <= 1.2 * level))


@pytest.mark.slow
def test_pysindy_reaches_the_noise_on_its_own_ground(residual: Residual) -> None:
    pytest.importorskip("pysindy", reason="PySINDy is not installed: pip install 'schmidt[bench]'")
    answer = sindy(residual)
    assert answer.named
    assert answer.before == pytest.approx(rms(residual.left[residual.test]))
    assert answer.after < 1.5


@pytest.mark.slow
def test_scipy_reaches_the_noise_on_its_own_ground(residual: Residual) -> None:
    answer = whole_vector(residual)
    assert answer.named
    assert answer.after < 1.5 < answer.before


def test_a_missing_peer_gets_one_clear_line(residual: Residual, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pysindy", None)
    with pytest.raises(MissingPeer, match=r"PySINDy is not installed: pip install 'schmidt\[bench\]'"):
        sindy(residual)
