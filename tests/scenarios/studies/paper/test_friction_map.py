"""Points of the torque-velocity map against arithmetic: ripple, weights, errors, break-away."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from scenarios.studies.paper.friction_map import (
    EXPONENTS,
    FrictionFit,
    MapPoint,
    break_away_point,
    drive_torque,
    fit_friction,
    friction_curve,
    over_angle,
    ripple_free,
    steady_point,
)
from scenarios.studies.paper.measures import Array
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, ARCSEC, GEAR_RATIO, Drive
from tests.scenarios.studies.paper.bench import log_of

SHEET = Drive(
    torque_constant=0.5, winding=1.0, switch=0.0, inductance=1e-3, diode_drop=None, rotor=1.0, stiffness=1.0,
    voltage=24.0, split=0.2, ripple=0.4,
)  # fmt: skip
STEPLESS = np.sqrt(2.0 / 12.0) * ADC_A_PER_COUNT * 0.5 * GEAR_RATIO
"""N m: two currents that rest anywhere within a step of the converter."""
AT = 0.5 * GEAR_RATIO  # N m at the axis for an ampere.


@pytest.mark.parametrize(("sign", "lead", "lag"), [(1.0, 0, 1), (-1.0, 1, 0)])
def test_half_the_ripple_of_the_duty_is_taken_off(sign: float, lead: int, lag: int) -> None:
    """A duty of 0.5 leads, 0.1 lags: 0.4 A * 0.25 and 0.4 A * 0.09."""
    found = ripple_free(log_of(0.0, effort=sign * 1500.0, amperes=(2.0, 2.0)), SHEET)
    assert found[lead] == pytest.approx(1.9) and found[lag] == pytest.approx(1.964)
    assert not np.any(ripple_free(log_of(0.0, effort=1500.0), SHEET))  # no current below none


def test_an_effort_of_nothing_has_no_ripple_and_B_pulls_against_A() -> None:
    log = log_of(0.0, amperes=(3.0, 1.0))
    assert drive_torque(log, SHEET) == pytest.approx(2.0 * AT)
    assert log.effort[0] == 0.0


@given(st.floats(1.0, 1e4), st.sampled_from([1.0, -1.0]))
def test_weights_are_shares_of_the_angle(rate: float, sign: float) -> None:
    assert over_angle(log_of(sign * rate)) == pytest.approx(0.01)
    step: Array = np.where(np.arange(100) < 50, rate, 3 * rate) * sign
    share = over_angle(log_of(step))
    assert share.sum() == pytest.approx(1.0)
    assert share[20] * 3 == pytest.approx(share[80])


def test_weights_are_means_over_15_samples_and_never_negative() -> None:
    rate: Array = np.where(np.arange(100) == 50, 1000.0, 100.0)
    share = over_angle(log_of(rate))
    assert share[43] == pytest.approx(share[0] * 1.6) and share[42] == pytest.approx(share[0])
    back: Array = np.where(np.arange(100) < 30, -10.0, 100.0)
    assert not over_angle(log_of(back))[:20].any()


def test_an_axis_at_rest_has_equal_weights_and_a_slow_one_has_not() -> None:
    assert over_angle(log_of(0.0)) == pytest.approx(0.01)
    share = over_angle(log_of(np.where(np.arange(100) < 50, 1e-3, 3e-3)))
    assert share[20] * 3 == pytest.approx(share[80])


def test_a_point_is_half_the_difference_of_both_ways() -> None:
    """300 N m forward, -180 back at 500 and -700 arcsec/s; no noise but the converter's."""
    sheet = replace(SHEET, ripple=0.0)
    there = log_of(500.0, amperes=(300.0 / AT, 0.0))
    back = log_of(-700.0, amperes=(0.0, 180.0 / AT))
    point = steady_point(there, back, sheet)
    assert point.rate == pytest.approx(600.0 * ARCSEC)
    assert point.torque == pytest.approx(240.0)
    assert point.spread == point.unrest == pytest.approx(np.sqrt(2.0) * STEPLESS / 2.0)


def test_the_error_is_white_noise_over_a_root_of_all_samples() -> None:
    """Noise of 2 A one way, of 1 A the other: their errors over 10 s, and the converter's."""
    sheet, random = replace(SHEET, ripple=0.0), np.random.default_rng(1)
    logs = [
        log_of(sign * 100.0, 40.0, amperes=(20.0 + size * random.standard_normal(4000), 20.0))
        for sign, size in ((1.0, 2.0), (-1.0, 1.0))
    ]
    point = steady_point(logs[0], logs[1], sheet)
    noise = np.hypot(2.0, 1.0) * AT / np.sqrt(4000)
    assert point.spread == pytest.approx(np.hypot(noise, np.sqrt(2.0) * STEPLESS) / 2.0, rel=0.05)


def test_unrest_is_that_of_ten_blocks() -> None:
    """Blocks that are +1 A and -1 A in turn: their deviation with nine degrees of freedom over root ten."""
    sheet = replace(SHEET, ripple=0.0)
    swing = np.repeat(np.tile([1.0, -1.0], 5), 10)
    logs = [
        log_of(sign * 100.0, amperes=(5.0 + size * swing, 5.0)) for sign, size in ((1.0, 2.0), (-1.0, 1.0))
    ]
    expected = np.hypot(2.0, 1.0) * AT * np.sqrt(10 / 9) / np.sqrt(10.0)
    found = steady_point(logs[0], logs[1], sheet).unrest
    assert found == pytest.approx(np.hypot(expected, np.sqrt(2.0) * STEPLESS) / 2.0)
    assert MapPoint(1.0, 2.0, 3.0).unrest == 0.0


def creeping(sign: float, level: float, gone_at: int | None) -> "tuple[Array, Array, Array]":
    """Rate and currents: creeps at 10 arcsec/s, the torque rises by steps of 15 samples up to `level` N m."""
    rate = np.full(100, sign * 10.0)
    torque = level * np.minimum(1.0, np.arange(100) // 15 / 4)
    if gone_at is not None:
        rate[gone_at:] = sign * 60.0
        torque[gone_at:] = 3 * level
    zero = np.zeros(100)
    amperes = torque / AT
    return (rate, amperes, zero) if sign > 0 else (rate, zero, amperes)


def test_break_away_is_the_largest_torque_before_the_axis_is_gone() -> None:
    sheet = replace(SHEET, ripple=0.0)
    logs = []
    for sign, level in ((1.0, 500.0), (-1.0, 300.0)):
        rate, a, b = creeping(sign, level, 80)
        logs.append(log_of(rate, amperes=(a, b)))
    point = break_away_point(logs[0], logs[1], sheet)
    assert point.torque == pytest.approx(400.0)
    assert point.rate == pytest.approx(10.0 * ARCSEC)
    assert point.spread == pytest.approx(0.025 * 400.0)


def test_an_axis_that_never_goes_or_at_once_has_a_point_all_the_same() -> None:
    sheet = replace(SHEET, ripple=0.0)
    still = [log_of(0.0, amperes=(a, b)) for a, b in ((100.0 / AT, 0.0), (0.0, 100.0 / AT))]
    point = break_away_point(still[0], still[1], sheet)
    assert (point.rate, point.torque) == pytest.approx((0.1 * ARCSEC, 100.0))
    quick = [log_of(sign * 60.0, amperes=(100.0 / AT, 0.0)) for sign in (1.0, -1.0)]
    assert break_away_point(quick[0], quick[1], sheet).torque == pytest.approx(0.0)
    first = [
        replace(log_of(0.0), adc_a=np.where(np.arange(100) < 15, way, 0.0) / ADC_A_PER_COUNT)
        for way in (1, 0)
    ]
    assert break_away_point(first[0], first[1], sheet).torque == pytest.approx(AT / 2.0)
    edge = [log_of(sign * 20.0 * 2.2959, amperes=(a, b)) for sign, a, b in ((1, 90.0, 0.0), (-1, 0.0, 90.0))]
    assert break_away_point(edge[0], edge[1], sheet).torque == pytest.approx(90.0 * AT)


def test_the_curve_has_its_limits() -> None:
    """At rest Ts, at vs Tc + (Ts - Tc) / e, far above the viscous branch; it is even."""
    given_ = (200.0, 600.0, 4e-4, 1.3, 7000.0)
    rates = np.array([0.0, 4e-4, -4e-4, 1.0])
    at_vs = 200.0 + 400.0 * np.exp(-1.0) + 2.8
    assert friction_curve(rates, given_) == pytest.approx([600.0, at_vs, at_vs, 7200.0])
    assert FrictionFit(*given_).torque(rates) == pytest.approx(friction_curve(rates, given_))


@pytest.mark.parametrize("exponent", [None, 0.9])
def test_the_fit_returns_what_the_map_was_made_of(exponent: float | None) -> None:
    rates = np.geomspace(10.0, 7200.0, 20) * ARCSEC
    truth = (217.0, 1490.0, 7e-4, 0.9, 11300.0)
    torque = friction_curve(rates, truth)
    points = [MapPoint(float(w), float(t), 1.0) for w, t in zip(rates, torque, strict=True)]
    points.append(MapPoint(0.01, 900.0, 1e6))  # known to nobody
    found = fit_friction(points, exponent)
    measured = (found.coulomb, found.stiction, found.stribeck_rate, found.exponent, found.viscous)
    assert measured == pytest.approx(truth, rel=2e-3)
    if exponent is not None:
        assert found.exponent == pytest.approx(exponent, rel=2e-6)
    assert EXPONENTS == (0.5, 2.0)


def test_twenty_counts_are_no_break_away() -> None:
    """The torque is largest at the end, while the axis still creeps by just as much."""
    sheet, torque = replace(SHEET, ripple=0.0), np.where(np.arange(100) < 80, 10.0, 20.0)
    logs = []
    for sign, a, b in ((1.0, torque, 0.0), (-1.0, 0.0, torque)):
        log = log_of(0.0, amperes=(a / AT, b / AT))
        logs.append(replace(log, counts=np.full(100, sign * 20.0)))
    assert break_away_point(logs[0], logs[1], sheet).torque == pytest.approx(20.0)


@pytest.mark.parametrize("factor", [2e-3, 400.0])
def test_a_map_beyond_the_bounds_is_fitted_all_the_same(factor: float) -> None:
    """Torques of less than 1 N m, or of more than 1e5: starts lie within the bounds."""
    points = [MapPoint(w, factor * (300.0 + 1e4 * w), 1.0) for w in (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2)]
    assert fit_friction(points).stiction > 0.0


def test_a_map_of_five_points_is_refused_by_its_number_and_one_of_six_is_not() -> None:
    points = [MapPoint(w, 300.0 + 1e4 * w, 1.0) for w in (1e-4, 3e-4, 1e-3, 3e-3, 1e-2, 3e-2)]
    assert fit_friction(points).viscous == pytest.approx(1e4, rel=0.2)
    with pytest.raises(ValueError, match=r"^a torque-velocity map needs at least 6 steady points, not 5$"):
        fit_friction(points[1:])
