"""Every row on an axis made by arithmetic: it passes what the paper describes and misses what it must
miss."""

import numpy as np
import pytest

from plant.model import load
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import closed as in_loop
from scenarios.studies.paper.experiments import opened as out_of_loop
from scenarios.studies.paper.experiments.closed import stick_slips
from scenarios.studies.paper.experiments.friction import CONSTANT_ERROR, Noise
from scenarios.studies.paper.experiments.identify import FirstOrder, fit, second_order
from scenarios.studies.paper.experiments.models import RULES
from scenarios.studies.paper.rows import Row
from scenarios.studies.paper.scales import COUNT_RATE
from scenarios.studies.paper.starts import STARTS, Benches
from tests.studies.paper.synthetic import log_of

PLANTS = {"low": load(LOW), "high": load(HIGH)}


class Axis:
    """Runs at its set point with a ripple: percent by speed, Hz; closed(speed), opened(speed) give the
    percent."""

    def __init__(self, closed, opened=None, hertz=5.0):
        self.closed, self.opened, self.hertz, self.speed = closed, opened or closed, hertz, 0.0

    def closed_loop(self, arcsec_s, seconds):
        self.speed = arcsec_s
        return self._log(self.closed(arcsec_s), seconds)

    def open_loop(self, effort, seconds):
        return self._log(self.opened(self.speed), seconds)

    def _log(self, percent, seconds):
        t = np.arange(0.0, seconds, 0.01)
        return log_of(self.speed * (1.0 + percent / 100.0 * np.sin(2 * np.pi * self.hertz * t)))


def met(experiment, make):
    benches = Benches(lambda *_: make(), PLANTS, STARTS[0])
    return Row(experiment, {STARTS[0]: experiment.measure(benches)}).passed


@pytest.mark.parametrize(("percent", "passed"), [(9.0, False), (12.0, True), (24.9, True), (26.0, False)])
def test_E1_between_10_and_25_percent(percent, passed):
    assert met(in_loop.low_preload, lambda: Axis(lambda v: percent)) is passed


@pytest.mark.parametrize(
    ("closed", "opened", "passed"),
    [(3.0, 5.0, True), (3.0, 2.0, False), (1.0, 5.0, False), (7.5, 9.0, False)],
)
def test_E3_within_the_band_and_no_worse_than_the_open_loop(closed, opened, passed):
    assert met(in_loop.higher_speeds, lambda: Axis(lambda v: closed, lambda v: opened)) is passed


def test_E3_one_speed_outside_is_a_miss():
    assert not met(in_loop.higher_speeds, lambda: Axis(lambda v: 7.4 if v == 900.0 else 4.0, lambda v: 9.0))


@pytest.mark.parametrize(("percent", "passed"), [(0.9, True), (1.1, False)])
def test_E4_below_one_percent(percent, passed):
    assert met(in_loop.slow_slews, lambda: Axis(lambda v: percent)) is passed


@pytest.mark.parametrize(("opened", "passed"), [(12.0, True), (16.0, False), (7.0, False), (8.5, True)])
def test_E5_at_most_15_percent_and_as_much_more_than_the_closed_loop_as_printed(opened, passed):
    assert met(out_of_loop.higher_speeds, lambda: Axis(lambda v: 4.0, lambda v: opened, 0.3)) is passed


def test_E5_a_drift_is_no_oscillation():
    t = np.arange(0.0, 70.0, 0.01)
    drift = 600.0 * (1.0 + 0.12 * np.sin(2 * np.pi * 0.004 * t))
    assert out_of_loop.fast_peak(drift, 600.0) < 0.5
    assert out_of_loop.fast_peak(drift + 30.0 * np.sin(2 * np.pi * 0.3 * t), 600.0) == pytest.approx(
        5.0, abs=0.5
    )


def test_E13_an_error_that_stays_for_seconds_is_not_negligible():
    assert met(in_loop.negligible, lambda: Axis(lambda v: 1.2))
    assert not met(in_loop.negligible, lambda: Axis(lambda v: 15.0, hertz=0.05))


def test_E13_a_fast_ripple_that_means_of_a_second_hide_is_not_negligible():
    ripple = in_loop.negligible.measure(Benches(lambda *_: Axis(lambda v: 5.0), PLANTS, STARTS[0]))
    assert ripple["worst"] < 0.1
    assert ripple["worst raw"] == pytest.approx(5.0 / np.sqrt(2.0), rel=0.01)


def test_E15_high_preload_may_not_err_by_more_than_a_quarter():
    assert met(in_loop.both_preloads, lambda: Axis(lambda v: 20.0))
    assert not met(in_loop.both_preloads, lambda: Axis(lambda v: 30.0))


def slips(rate, still_s=1.0, leap=60.0):
    one = np.concatenate([np.full(round(still_s * 100), rate), np.full(20, leap)])
    return stick_slips(log_of(np.tile(one, 5)), 15.0, 2.0)


def test_E2_a_cycle_needs_a_stick_phase_and_a_leap():
    assert slips(0.0) == 5
    assert slips(0.9) == 5  # below half a count
    assert slips(4.0) == 0  # it creeps: no stick
    assert slips(0.0, still_s=0.05) == 0  # too short
    assert slips(0.0, leap=25.0) == 0  # no leap
    assert stick_slips(log_of(np.zeros(1000)), 15.0, 2.0) == 0
    counts = np.tile([6.0, 7.0], 500)
    assert stick_slips(log_of(counts * COUNT_RATE), 15.0, 2.0) == 0


def test_E11_a_loop_that_never_sticks_misses_the_row():
    assert not met(in_loop.low_gains, lambda: Axis(lambda v: 20.0))


@pytest.mark.parametrize(("gain", "lag", "dead"), [(1.9, 0.066, 0.0085), (3.0, 0.02, 0.03), (0.5, 0.2, 0.01)])
def test_E10_the_identified_model_is_the_one_that_made_the_response(gain, lag, dead):
    t = np.arange(100) * 0.01 + 0.0025  # the first row that shows the effort is 2.5 ms younger on average
    response = gain * (1.0 - np.exp(-np.maximum(0.0, t - dead) / lag))
    found = fit(response)
    in_the_loop = dead + 0.0025  # and half a period of holding
    assert (found.gain, found.lag_s) == pytest.approx((gain, lag), rel=0.05)
    assert found.dead_s == pytest.approx(in_the_loop, abs=0.001)


@pytest.mark.parametrize(
    ("frequency", "damping", "dead"), [(31.0, 0.4, 0.005), (60.0, 1.0, 0.01), (25.0, 3.0, 0.0)]
)
def test_E10_the_second_order_is_found_from_rows_10_ms_apart(frequency, damping, dead):
    t = np.arange(100) * 0.01 + 0.0025
    # by Euler's method in steps of 10 us, not by the formula of the fit
    dt, y, v, wanted, at = 1e-5, 0.0, 0.0, [], 0
    for moment in t:
        while at * dt < moment:
            force = frequency**2 * ((1.0 if at * dt >= dead else 0.0) - y) - 2.0 * damping * frequency * v
            v += force * dt
            y += v * dt
            at += 1
        wanted.append(3.0 * y)
    found = second_order(t, np.array(wanted))
    assert found.gain == pytest.approx(3.0, rel=0.02)
    assert found.response(t) == pytest.approx(np.array(wanted), abs=0.01)
    assert found.dead_s == pytest.approx(dead, abs=0.001)
    if damping < 2.0:
        assert (found.frequency, found.damping) == pytest.approx((frequency, damping), rel=0.03)


def test_E10_the_rules_give_the_gains_worked_out_by_hand():
    # k = 2, T = 100 ms, L = 20 ms, 5 ms period; kp and ki = kp * 5 ms / Ti by a pocket calculator
    model = FirstOrder(2.0, 0.1, 0.02)
    by_hand = {
        "Ziegler-Nichols": (2.25, 0.16892),
        "Chien 0 %": (0.875, 0.037393),
        "Chien 20 %": (1.5, 0.075),
        "Cohen-Coon": (2.2915, 0.24388),
        "Rivera": (1.61765, 0.073529),
        "Skogestad": (1.25, 0.0625),
        "AMIGO": (0.60278, 0.038813),
    }
    for name, (kp, ki) in by_hand.items():
        assert RULES[name](model) == pytest.approx((kp, ki), rel=1e-3), name


def test_E7_noise_is_that_of_the_seed_and_the_constant_is_off_by_at_most_5_percent():
    log = log_of(np.full(2000, 600.0), current=np.full(2000, 1.0))
    one, same, other = (Noise(seed, "x") for seed in (1, 1, 2))
    assert np.array_equal(one.log(log).adc_a, same.log(log).adc_a)
    assert abs(one.constant - 1.0) <= CONSTANT_ERROR
    assert one.constant != other.constant
    read = other.log(log)
    expected = np.hypot(np.hypot(1.0, 0.01 * log.adc_a[0]), 12**-0.5)  # one count, 1 %, and rounding
    assert read.adc_a.std() == pytest.approx(expected, rel=0.05)
    assert read.adc_a.mean() == pytest.approx(log.adc_a[0], rel=0.01)
