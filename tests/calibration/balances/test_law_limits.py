"""Gains that change at a speed, regimes of the set point, and pulses at their limits."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.effortchange import LIMITS, incremental_law, likeliest_limit, pulses, usual_regime
from tests.calibration.balances.test_effortchange import loop

ROWS = 6000
RNG = np.random.default_rng(1)
X: np.ndarray = RNG.standard_normal((ROWS, 2))


def limited(at: float, rate: np.ndarray | None = None, train: np.ndarray | None = None) -> list[float]:
    rate = RNG.uniform(0, 2000, ROWS) if rate is None else rate
    gains = np.where((rate < at)[:, None], [3.0, 1.0], [1.0, 2.0])
    y = np.sum(X * gains, axis=1)
    p: Any = Some(train=np.ones(ROWS, dtype=bool) if train is None else train, base=X, y=y)
    return likeliest_limit(p, rate)


@pytest.mark.parametrize("place", [30, 40, 45])
def test_a_law_changes_at_the_limit_that_leaves_least(place: int) -> None:
    assert LIMITS[0] == 20.0 and LIMITS[-1] == pytest.approx(5000.0)
    assert LIMITS[1:] / LIMITS[:-1] == pytest.approx(np.full(56, 250 ** (1 / 56)))
    assert limited(float(LIMITS[place])) == [pytest.approx(LIMITS[place])]


def test_rows_that_are_no_good_tell_no_limit() -> None:
    rate = RNG.uniform(0, 2000, ROWS)
    half = np.arange(ROWS) < 3000
    spoiled = np.where(half, rate, 1e4 * RNG.random(ROWS))
    assert limited(float(LIMITS[40]), spoiled, half) == [pytest.approx(LIMITS[40])]


@pytest.mark.parametrize(("share", "told"), [(0.028, False), (0.032, True)])
def test_three_hundredths_of_the_rows_lie_on_either_side(share: float, told: bool) -> None:
    for low, high in ((100.0, 900.0), (900.0, 100.0)):
        rate = np.where(np.arange(ROWS) < share * ROWS, low, high)
        assert bool(limited(500.0, rate)) == told


def test_at_one_speed_there_is_no_limit() -> None:
    assert limited(500.0, np.full(ROWS, 900.0)) == []


def test_the_limits_are_those_of_set_point_and_rate_in_arcsec() -> None:
    given = loop()
    law = incremental_law(given, np.zeros(ROWS, dtype=bool))
    assert law is not None
    wanted = np.abs(given.columns["setpoint"]) * 180 * 3600 / np.pi
    assert law.rates["set_point_limit"].speed == pytest.approx(wanted)
    assert law.rates["set_point_limit"].unit == "arcsec/s"
    p = law.problem
    assert (p.ar_order, p.block_s, p.period_s) == (4, 3.0, 0.01)
    assert not p.base[~p.valid].any() and not p.y[~p.valid].any() and np.array_equal(law.terms, p.base)


@pytest.mark.parametrize(("size", "kept"), [(0.979, True), (0.981, False)])
def test_an_effort_from_098_of_its_largest_on_is_at_its_limit(size: float, kept: bool) -> None:
    """Where that is more than nine tenths of the full one."""
    given = loop()
    effort = given.columns["effort"]
    effort *= 0.5 / np.abs(effort).max()
    effort[2000] = 0.95
    effort[3500] = size * 0.95
    law = incremental_law(given, np.zeros(ROWS, dtype=bool))
    assert law is not None and law.problem.valid[3500] == kept and not law.problem.valid[2000]
    effort[2000], effort[3500] = 0.89, size * 0.89
    law = incremental_law(given, np.zeros(ROWS, dtype=bool))
    assert law is not None and law.problem.valid[[2000, 3500]].all()


def test_a_board_s_own_log_is_looked_at_in_one_regime() -> None:
    given = loop()
    rate = 15.0 / (180 * 3600 / np.pi)
    given.columns["setpoint"][:3500] = rate
    law = incremental_law(given, np.zeros(ROWS, dtype=bool), own=True)
    assert law is not None and law.problem.valid[100:2900].all() and not law.problem.valid[3600:].any()
    every = incremental_law(given, np.zeros(ROWS, dtype=bool))
    assert every is not None and every.problem.valid[3600:5000].all()


@pytest.mark.parametrize(("rows", "told"), [(999, False), (1000, True)])
def test_a_law_needs_a_thousand_rows(rows: int, told: bool) -> None:
    given = loop()
    given.columns["velocity"][rows + 1 :] = np.nan
    given.columns["velocity"][0] = np.nan
    law = incremental_law(given, np.zeros(ROWS, dtype=bool))
    valid = 0 if law is None else int(law.problem.valid.sum())
    assert (law is not None) == told or valid in (0, rows)


def test_a_regime_is_told_over_fifty_rows() -> None:
    """A set rate that leaves its line by more than a ten-thousandth; slower than 200 creeps."""
    valid = np.ones(1000, dtype=bool)
    creeps = 50 + RNG.normal(0, 1, 300)
    for bend, straight in ((0.9e-4, True), (1.1e-4, False)):
        zigzag = 15.0 + bend / 4 * (-1.0) ** np.arange(700)
        kept = usual_regime(np.concatenate([zigzag, creeps]), valid)
        assert kept[100:600].all() and kept[760:990].all() != straight
    creeping = 199.0 + 0.5 * RNG.random(600)
    kept = usual_regime(np.concatenate([creeping, 201 + 0.5 * RNG.random(400)]), valid)
    assert kept[:600].all() and not kept[600:].any()


def spiked(count: int, period: int = 100, off: int = 0, size: float = 30.0) -> Any:
    """So many pulses, of which `off` come at half the period."""
    rows = (count + 2) * period
    e = np.random.default_rng(4).standard_normal(rows)
    at = period * (1 + np.arange(count))
    at[:off] += period // 2 * (np.arange(off) % 2)
    e[at] = size
    p: Any = Some(train=np.ones(rows, dtype=bool), t=0.01 * np.arange(rows), period_s=0.01, unit="1")
    return pulses(p, e)


def test_more_than_32_regular_spikes_are_pulses() -> None:
    assert spiked(32) is None and spiked(33) is not None and spiked(11) is None


def test_six_tenths_of_the_gaps_keep_the_period() -> None:
    assert spiked(200, off=60) is not None and spiked(200, off=100) is None


def test_spikes_within_five_rows_are_one_pulse() -> None:
    assert spiked(60, 4) is None and spiked(60, 7) is not None
