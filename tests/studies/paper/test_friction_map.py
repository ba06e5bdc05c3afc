"""Points of the torque-velocity map by formulas: shares of the angle, standard errors, the fitted curve."""

from dataclasses import replace

import numpy as np
import pytest

from scenarios.studies.paper.friction_map import (
    BREAK_AWAY_ERROR,
    EXPONENTS,
    WINDOW,
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
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, ARCSEC, GEAR_RATIO
from tests.studies.paper.synthetic import current_for, log_of
from tests.studies.paper.test_scales import SHEET

K = SHEET.torque_constant
CALM = replace(SHEET, ripple=0.0)


def both(rate: Array, torque: Array) -> tuple[Log, Log]:
    """There with motor A and back with motor B, the same torque."""
    back = replace(log_of(-rate), adc_b=current_for(torque, K) / ADC_A_PER_COUNT)
    return log_of(rate, current=current_for(torque, K)), back


def test_half_the_ripple_comes_off_the_motor_that_leads_and_the_one_that_lags() -> None:
    """V D (1 - D) / (2 L f), at D = 0.4 for the leading motor and 0.04 for the other."""
    n = 3
    both = replace(
        log_of(np.zeros(n), current=np.full(n, 1.0), effort=np.array([1200.0, -1200.0, 0.0])),
        adc_b=np.full(n, 1.0 / ADC_A_PER_COUNT),
    )
    a, b = ripple_free(both, SHEET)
    lead, lag = 1.0 - 0.3 * 0.4 * 0.6, 1.0 - 0.3 * 0.04 * 0.96
    assert a == pytest.approx([lead, lag, 1.0]) and b == pytest.approx([lag, lead, 1.0])
    assert drive_torque(both, SHEET) == pytest.approx(
        np.array([lead - lag, lag - lead, 0.0]) * K * GEAR_RATIO
    )
    assert not ripple_free(replace(both, adc_a=np.zeros(n)), SHEET)[0].any()  # no current is below none


def test_shares_of_the_angle_add_up_and_leave_out_what_goes_back() -> None:
    rate = np.repeat([200.0, 600.0, -100.0], 100)
    for sign in (1.0, -1.0):
        share = over_angle(log_of(sign * rate))
        assert share.sum() == pytest.approx(1.0)
        assert share[150] == pytest.approx(3.0 * share[50])
        assert share[0] == pytest.approx(share[50])  # an end has fewer neighbours, and no smaller share
        assert share[250] == 0.0
    slow = over_angle(log_of(np.append(np.zeros(20), np.full(20, 0.001))))
    assert slow[0] == 0.0 and slow[39] > 1.0 / 40
    assert over_angle(log_of(np.zeros(40))) == pytest.approx(np.full(40, 1.0 / 40))


def test_the_standard_error_of_a_point_is_that_of_noise_and_converter() -> None:
    """Torques that alternate by s: differences have the deviation 2 s, and blocks of ten none."""
    n, swing = 1000, 30.0
    wave = 200.0 + swing * np.tile([1.0, -1.0], n // 2)
    there, _ = both(np.full(n, 600.0), np.full(n, 200.0))  # without any
    point = steady_point(there, both(np.full(n, 600.0), wave)[1], CALM)
    step = ADC_A_PER_COUNT * K * GEAR_RATIO
    converter = np.sqrt(2.0) * step * np.sqrt(2.0 / 12.0)  # of two motors, and two runs
    noise = 2.0 * swing / np.sqrt(2.0 * n)
    assert point.torque == pytest.approx(200.0) and point.rate == pytest.approx(600.0 * ARCSEC)
    assert point.spread == pytest.approx(np.hypot(noise, converter) / 2.0, rel=1e-5)
    assert point.unrest == pytest.approx(converter / 2.0)


def test_unrest_is_the_wander_of_ten_blocks() -> None:
    blocks = np.repeat(200.0 + 10.0 * np.array([1, -1, 2, -2, 3, -3, 4, -4, 5, -5]), 100)
    point = steady_point(*both(np.full(1000, 600.0), blocks), CALM)
    of_mean = np.sqrt(110.0 * 100.0 / 9.0 / 10.0)  # squares of 1 to 5, twice; ten blocks
    step = ADC_A_PER_COUNT * K * GEAR_RATIO
    assert point.unrest == pytest.approx(np.hypot(of_mean, step * np.sqrt(1.0 / 6.0)) / np.sqrt(2.0))


def test_break_away_is_the_mean_of_a_window_before_the_axis_is_gone() -> None:
    """Torques there and back differ by the balance of the axis: half their sum is friction."""
    torque = np.linspace(0.0, 500.0, 101)
    rate = np.linspace(0.0, 20.0, 101)
    fast = np.full(50, 100.0)
    logs = []
    for balance in (40.0, -40.0):
        log = both(np.append(rate, fast), np.append(torque + balance + 60.0, np.full(50, 2000.0)))
        logs.append(log[balance < 0.0])
    point = break_away_point(logs[0], logs[1], CALM)
    last = slice(101 - WINDOW, None)
    assert WINDOW == 15  # 150 ms
    assert point.torque == pytest.approx(float(torque[last].mean()) + 60.0)
    assert point.rate == pytest.approx(float(rate[last].mean()) * ARCSEC)
    assert point.spread == pytest.approx(BREAK_AWAY_ERROR * point.torque) and point.unrest == 0.0


def test_an_axis_that_never_goes_or_goes_at_once_has_a_point_too() -> None:
    still = break_away_point(*both(np.zeros(40), np.linspace(0.0, 78.0, 40)), CALM)
    assert still.torque == pytest.approx(2.0 * (39 + 25) / 2) and still.rate == pytest.approx(0.1 * ARCSEC)
    gone = break_away_point(*both(np.full(30, 100.0), np.linspace(0.0, 58.0, 30)), CALM)
    assert gone.torque == pytest.approx(2.0 * 7) and gone.rate == pytest.approx(100.0 * ARCSEC)


def test_the_curve_falls_from_stiction_to_coulomb_friction_and_rises_by_viscous() -> None:
    numbers = (200.0, 600.0, 4e-4, 2.0, 5000.0)
    rates = np.array([1e-9, 4e-4, 8e-4, 1e-2])
    wanted = [600.0, 200 + 400 / np.e + 2, 200 + 400 / np.e**4 + 4, 250.0]
    assert friction_curve(rates, numbers) == pytest.approx(wanted, rel=1e-6)
    assert FrictionFit(*numbers).torque(-rates) == pytest.approx(wanted, rel=1e-6)


def test_the_fit_finds_the_curve_by_weight_and_keeps_to_its_bounds() -> None:
    truth = (229.0, 621.0, 4e-4, 0.7, 6700.0)
    rates = np.geomspace(2e-5, 0.03, 14)
    points = [MapPoint(*each, 5.0) for each in zip(rates, friction_curve(rates, truth), strict=True)]
    strays = [*points, MapPoint(1e-3, 900.0, 1e6)]  # a point of no weight
    found = fit_friction(strays)
    numbers = (found.coulomb, found.stiction, found.stribeck_rate, found.exponent, found.viscous)
    assert numbers == pytest.approx(truth, rel=0.02)
    assert fit_friction(points, 1.2).exponent == pytest.approx(1.2, rel=1e-5)
    assert EXPONENTS == (0.5, 2.0) and BREAK_AWAY_ERROR == 0.1 / 4  # a quarter, of a tenth


def test_six_points_are_enough_and_five_are_not() -> None:
    rates = np.geomspace(1e-4, 0.03, 6)
    points = [MapPoint(*each, 1.0) for each in zip(rates, 200.0 + 6700.0 * rates, strict=True)]
    assert fit_friction(points, 1.0).viscous == pytest.approx(6700.0, rel=0.05)
    with pytest.raises(ValueError, match=r"^a torque-velocity map needs at least 6 steady points, not 5$"):
        fit_friction(points[:5])
