"""The limit at which a law changes, and pulses just beyond what is told, in residuals made by hand."""

from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances import effortchange
from calibration.balances.effortchange import LIMITS, likeliest_limit, pulses, usual_regime
from plant.units import ARCSEC
from tests.calibration.balances.test_effortchange import COUNT_ARCSEC, ROWS, TICK_S, loop

law: Any = effortchange
MANY = 4000


def test_limits_are_a_tenth_apart_from_twenty_to_five_thousand() -> None:
    assert (LIMITS[0], LIMITS[-1], len(LIMITS)) == (pytest.approx(20), pytest.approx(5000), 57)
    assert LIMITS[1:] / LIMITS[:-1] == pytest.approx(1.1036, abs=1e-3)


def changing(limit: float, rates: Any, fitted: Any = None) -> list[float]:
    """Two gains below a limit and two others above it, in fitted rows; elsewhere they are the same."""
    rng = np.random.default_rng(3)
    x = rng.standard_normal((MANY, 2))
    train = np.ones(MANY, dtype=bool) if fitted is None else fitted
    below = (rates < limit) | ~train
    y = np.where(below, x @ [2.0, -1.0], x @ [3.0, 0.5])
    return likeliest_limit(Some(train=train, base=x, y=y), rates)  # type: ignore[arg-type]


EVEN = np.geomspace(10.0, 10_000.0, MANY)


@pytest.mark.parametrize("k", [8, 30, 50])
def test_a_law_that_changes_at_a_speed_is_told_by_it(k: int) -> None:
    rates = np.random.default_rng(1).permutation(EVEN)
    assert changing(LIMITS[k], rates) == [LIMITS[k]]
    assert changing(LIMITS[k], rates, np.arange(MANY) % 3 > 0) == [LIMITS[k]]


@pytest.mark.parametrize(("below", "told"), [(120, 0), (121, 1), (3879, 1), (3880, 0)])
def test_a_limit_has_more_than_three_in_a_hundred_rows_on_either_side(below: int, told: int) -> None:
    rates = np.where(np.arange(MANY) < below, 1.0, 9999.0)
    assert len(changing(500.0, rates)) == told


def spikes(
    *at: int, size: float = 20.0, noise: float = 1.0, rows: int = 20_000, valid: Any = None, edge: float = 0.0
) -> Any:
    """What is told of an even residual whose signs alternate, with spikes; `edge` follows each."""
    e = noise * np.resize([1.0, -1.0], rows)
    for k in at:
        e[k], e[k + 2] = size, -size
        e[k + 1] = edge
    train = np.ones(rows, dtype=bool) if valid is None else valid
    p: Any = Some(train=train, t=0.01 * np.arange(rows), period_s=0.01, unit="V")
    return pulses(p, e)


EVERY = range(100, 10_000, 200)  # fifty, of two spikes each


@pytest.mark.parametrize(
    ("size", "there"),
    [(7.3, False), (7.5, True)],  # five deviations: 1.4826 each
)
def test_a_spike_is_five_deviations(size: float, there: bool) -> None:
    assert (spikes(*EVERY, size=size) is not None) == there


@pytest.mark.parametrize(("edge", "count"), [(-7.9, 20.0), (-8.1, 18.0)])
def test_what_is_smaller_than_two_fifths_of_the_large_ones_is_no_edge(edge: float, count: float) -> None:
    """The median of what counts: of two edges of 20, or of a third one beside them."""
    found = spikes(*EVERY, edge=edge)
    share = 2 * 50 * 400.0 / (2 * 50 * 400 + 50 * edge**2 + 20_000 - 150)
    more = 0.0 if abs(edge) < 8 else 50 * edge**2 / (2 * 50 * 400 + 50 * edge**2 + 20_000 - 150)
    assert found.share == pytest.approx(share + more, rel=1e-3)


@pytest.mark.parametrize(("count", "there"), [(16, False), (17, True)])
def test_more_than_thirty_two_regular_spikes_are_pulses(count: int, there: bool) -> None:
    assert (spikes(*range(100, 100 + 200 * count, 200)) is not None) == there


def test_few_spikes_or_gaps_are_none(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(law, "LEAST_PULSES", 0)
    assert spikes(*range(100, 1300, 200)) is None  # six: five gaps
    assert spikes(*range(100, 1500, 200)) is not None
    one_way = list(range(100, 1300, 200))
    assert spikes(*one_way[:5]) is None  # ten spikes


@pytest.mark.parametrize(("odd", "there"), [(39, True), (41, False)])
def test_three_fifths_of_the_gaps_keep_the_period(odd: int, there: bool) -> None:
    """Of a hundred gaps of 100 rows so many are six rows longer, and one in twenty is allowed."""
    gaps = np.where(np.arange(100) < odd, 106, 100)
    found = spikes(*np.cumsum(gaps).tolist())
    assert (found is not None) == there
    if there:
        assert found.note == "pulses on the command, every 1.00 s"
        assert found.evidence == pytest.approx(100 * _distance((99 - odd) / 99, 0.1) / np.log(10), rel=0.03)


def _distance(share: float, chance: float) -> float:
    """Of two shares (Kullback and Leibler)."""
    return float(share * np.log(share / chance) + (1 - share) * np.log((1 - share) / (1 - chance)))


def test_gaps_of_several_periods_tell_it_too_and_quick_ones_nothing() -> None:
    at = np.cumsum(np.where(np.arange(60) % 4 == 3, 300, 100))
    found = spikes(*at.tolist())
    assert found.parameters["period"].value == pytest.approx(1.0)
    assert found.parameters["size"].value == pytest.approx(20.0) and found.parameters["size"].unit == "V"
    near = sorted([*EVERY, *(k + 4 for k in EVERY)])  # again after four rows
    assert spikes(*near).parameters["period"].value == pytest.approx(1.96)  # the rest of each 200 rows
    half = np.arange(20_000) < 3000
    assert spikes(*EVERY, valid=half) is None  # fifteen of them are fitted


def test_effort_at_its_end_says_nothing_from_nine_tenths_of_full_on() -> None:
    for top, limited in ((0.89, False), (0.91, True)):
        given = loop()
        effort = given.columns["effort"]
        effort *= 0.5 * top / np.abs(effort).max()
        effort[3200], effort[3300] = top, 0.979 * top
        effort[3400] = -0.981 * top
        found = law.incremental_law(given, np.zeros(ROWS, dtype=bool))
        valid = found.problem.valid
        assert valid[3200] == valid[3400] == (not limited) and valid[3300]


def test_a_thousand_rows_are_a_law() -> None:
    for rows, there in ((1000, True), (999, False)):
        given = loop()
        given.columns["velocity"][2 + rows :] = np.nan
        assert (law.incremental_law(given, np.zeros(ROWS, dtype=bool)) is not None) == there


def test_the_rates_of_a_law_are_sizes_in_arcsec_per_second(monkeypatch: pytest.MonkeyPatch) -> None:
    given = loop()
    given.columns["setpoint"] = -given.columns["setpoint"]
    monkeypatch.setattr(law, "likeliest_limit", lambda p, x: [float(np.max(x))])
    found = law.incremental_law(given, np.zeros(ROWS, dtype=bool))
    for name, column in (("set_point_limit", "setpoint"), ("rate_limit", "velocity")):
        size = np.abs(given.columns[column]) / ARCSEC
        assert found.rates[name].speed == pytest.approx(size) and found.rates[name].unit == "arcsec/s"
        assert found.rates[name].limits == [float(size.max())]
    assert found.problem.block_s == 3.0 and found.problem.ar_order == 4
    assert pytest.approx(2.3) == COUNT_ARCSEC / TICK_S  # arcsec/s a count


def test_a_whole_effort_may_be_a_hundredth_of_a_step_off() -> None:
    for off, whole in ((0.009, True), (0.02, False)):
        given = loop()
        given.columns["effort"] = (np.round(given.columns["effort"] * 3000.0) + off) / 3000.0
        found = law.incremental_law(given, np.zeros(ROWS, dtype=bool))
        assert (found.problem.floor > 0) == whole


@pytest.mark.parametrize(("speed", "creeps"), [(199.0, True), (201.0, False)])
def test_pointing_creeps_below_200_arcsec_per_second(speed: float, creeps: bool) -> None:
    rng = np.random.default_rng(1)
    slow = np.where(np.arange(1000) < 600, speed, 100.0 if not creeps else 900.0) + rng.normal(0, 0.1, 1000)
    kept = usual_regime(slow, np.ones(1000, dtype=bool))
    assert kept[:500].mean() > 0.9 and kept[700:].mean() < 0.1


@pytest.mark.parametrize(("bend", "straight"), [(0.9e-4, True), (1.1e-4, False)])
def test_a_set_rate_is_straight_to_a_ten_thousandth(bend: float, straight: bool) -> None:
    wave = np.resize([0.0, bend / 2], 1000)
    wanted = np.concatenate([15.0 + wave, 50.0 + np.random.default_rng(1).normal(0, 1, 900)])
    kept = usual_regime(wanted, np.ones(1900, dtype=bool))
    assert kept[100:900].all() and (kept[1100:1800].mean() < 0.5) == straight
