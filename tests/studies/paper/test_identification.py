import dataclasses

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plant.model import load, with_effects, with_value
from scenarios.studies.paper.experiments.friction import RUN_DOWN_SPEEDS, Noise, friction_map
from scenarios.studies.paper.experiments.identify import identify
from scenarios.studies.paper.friction_map import (
    FrictionFit,
    MapPoint,
    break_away_point,
    drive_torque,
    fit_friction,
    friction_curve,
    steady_point,
)
from scenarios.studies.paper.rundown import Coasting, coast, fit_run_downs
from scenarios.studies.paper.runs import (
    MAP_SPEEDS,
    MOTOR_TURN_ARCSEC,
    last_half_turns,
    map_pair,
    opened_pair,
    run_down,
)
from scenarios.studies.paper.scales import (
    ADC_A_PER_COUNT,
    ARCSEC,
    COUNT_RATE,
    GEAR_RATIO,
    INERTIA,
    LOG_PERIOD_S,
    TABLE_2,
    Drive,
    drive,
)
from scenarios.studies.paper.starts import STARTS, Benches, EmulatorBench, Start, with_inertia
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.synthetic import current_for, log_of

K = 0.8  # N m/A
RIGID = Drive(
    torque_constant=1e-6,
    winding=0.8,
    switch=0.2,
    inductance=1e-4,
    diode_drop=None,
    rotor=4.0,
    stiffness=2e7,
    voltage=24.0,
    split=0.1,
    ripple=0.0,
)
"""No motors to speak of, on trains that hardly give."""
SHEET = dataclasses.replace(RIGID, torque_constant=K)
RATES = np.array(sorted(MAP_SPEEDS)) * ARCSEC


def table(preload: str, exponent: float) -> tuple[float, ...]:
    printed = TABLE_2[preload]
    return printed["coulomb"], printed["stiction"], printed["stribeck_rate"], exponent, printed["viscous"]


@settings(max_examples=25, deadline=None)
@given(st.sampled_from(["low", "high"]), st.floats(0.55, 2.0), st.integers(0, 1000))
def test_E7_the_fit_returns_the_parameters_the_map_was_made_with(preload, exponent, seed):
    truth = table(preload, exponent)
    noise = 1.0 + 0.002 * np.random.default_rng(seed).standard_normal(RATES.size)
    points = [
        MapPoint(float(w), float(t), 1.0)
        for w, t in zip(RATES, friction_curve(RATES, truth) * noise, strict=True)
    ]
    found = fit_friction(points, exponent)
    for value, true in zip((found.coulomb, found.stiction, found.stribeck_rate), truth[:3], strict=True):
        assert value == pytest.approx(true, rel=0.06)
    assert found.viscous == pytest.approx(truth[4], rel=0.03)


def test_E7_the_exponent_is_found_when_it_is_not_given():
    truth = table("low", 1.3)
    points = [
        MapPoint(float(w), float(t), 1.0) for w, t in zip(RATES, friction_curve(RATES, truth), strict=True)
    ]
    assert fit_friction(points).exponent == pytest.approx(1.3, rel=0.01)


def test_E7_a_map_of_a_few_points_is_refused():
    with pytest.raises(ValueError, match="at least 6"):
        fit_friction([MapPoint(1e-3, 300.0, 1.0)] * 5)


def test_E7_a_steady_point_is_mean_torque_at_mean_rate():
    rate = np.full(1000, 600.0)
    # balance pushes both ways alike: 40 N m more forward, 40 less backward
    forward = log_of(rate, current=current_for(np.full(1000, 290.0), K))
    backward = dataclasses.replace(
        log_of(-rate), adc_b=current_for(np.full(1000, 210.0), K) / ADC_A_PER_COUNT
    )
    point = steady_point(forward, backward, SHEET)
    assert point.torque == pytest.approx(250.0)
    assert point.rate == pytest.approx(600.0 * ARCSEC)


def test_E7_what_the_gears_add_over_the_angle_adds_nothing_to_a_point():
    """Lingering where the gears hold it back, an axis meets them longer: over time their mean is 0.7 %."""
    angle = 0.0
    rate: list[float] = []
    gears: list[float] = []
    while angle < 2.0 * 2.0 * np.pi:  # two turns of ten seconds
        speed = 1.0 + 0.1 * np.cos(angle)
        rate.append(500.0 * speed)
        gears.append(-25.0 * np.cos(angle))
        angle += 2.0 * np.pi * speed / 1000.0
    assert abs(np.mean(gears)) > 1.0
    torque = 170.0 + np.array(gears)
    forward = log_of(np.array(rate), current=current_for(torque, K))
    backward = dataclasses.replace(log_of(-np.array(rate)), adc_b=current_for(torque, K) / ADC_A_PER_COUNT)
    point = steady_point(forward, backward, SHEET)
    assert point.torque == pytest.approx(170.0, rel=5e-4)
    assert 5.0 * point.spread < point.unrest  # the gears are no error of the mean


def test_E7_an_opened_run_is_cut_to_whole_half_turns_by_the_encoder():
    """Half as fast in the first ten seconds: whole turns at the mean speed would not be whole."""
    rate = np.repeat([400.0, 800.0], [1000, 2000])
    kept = last_half_turns(log_of(rate))
    turns = kept.rate.sum() * LOG_PERIOD_S / (MOTOR_TURN_ARCSEC / 2.0)
    assert turns == pytest.approx(11.0, abs=0.005)
    short = log_of(np.full(300, 100.0))
    assert last_half_turns(short) is short


class Rails:
    """A bench whose axis is at once at its speed: where it was is all that it says."""

    def __init__(self) -> None:
        self.at = 0.0

    def closed_loop(self, arcsec_s, seconds):
        rate = np.full(round(seconds / LOG_PERIOD_S), arcsec_s)
        where = self.at + LOG_PERIOD_S * np.cumsum(rate)
        self.at = float(where[-1])
        return dataclasses.replace(log_of(rate), true_rate=where)

    def open_loop(self, effort, seconds):
        return self.closed_loop(5.0 * effort, seconds)


@pytest.mark.parametrize(
    ("pair", "whole"),
    [(lambda: map_pair(Rails(), 1000.0), 1.0), (lambda: opened_pair(Rails(), 500.0, 100, -100), 0.9)],
    ids=["closed loop", "opened"],
)
def test_E7_there_and_back_go_over_the_same_stretch(pair, whole):
    """The balance of the axis changes by 0.1 N m and more in a degree."""
    (there, back) = (log.true_rate for log in pair())
    common = min(there.max(), back.max()) - max(there.min(), back.min())
    assert common >= whole * (there.max() - there.min()) - 20.0


def test_E7_break_away_is_the_largest_torque_before_the_axis_is_gone():
    torque = np.concatenate([np.linspace(0.0, 600.0, 1000), np.full(200, 250.0)])
    rate = np.concatenate([np.zeros(990), np.full(10, 5.0), np.full(200, 2000.0)])
    backward = dataclasses.replace(log_of(-rate), adc_b=current_for(torque, K) / ADC_A_PER_COUNT)
    point = break_away_point(log_of(rate, current=current_for(torque, K)), backward, SHEET)
    assert 590.0 < point.torque <= 600.0
    assert point.rate < 10.0 * ARCSEC


@pytest.mark.parametrize("inertia", [1200.0, 1760.0, 2200.0])
def test_E8_without_motors_an_axis_coasts_as_friction_and_inertia_have_it(inertia):
    fit = FrictionFit(*table("low", 1.0))
    dt, begin = 1e-5, 2.0 * 3600 * ARCSEC
    w, rates = begin, []
    for _ in range(10_000):
        w = max(0.0, w - float(fit.torque(np.array([max(w, 1e-9)]))[0]) / inertia * dt)
        rates.append(w)
    expected = np.array(rates).reshape(10, 1000)[:, 500:].mean(axis=1) / ARCSEC / COUNT_RATE
    axis = Coasting(inertia=inertia, damping=300.0, late_s=0.0)
    found = coast(RIGID, fit, axis, np.array([begin]), 10)[0]
    assert found == pytest.approx(expected, rel=0.02)


def test_E8_an_axis_that_was_at_rest_is_refused():
    fit = FrictionFit(*table("low", 1.0))
    with pytest.raises(ValueError, match="only 0 samples"):
        fit_run_downs([log_of(np.zeros(100))], [7200.0], fit, RIGID)


def other(name):
    """A plant that nobody tuned the methods on."""
    model = load(f"{name}_preload_bridge")
    for path, factor in OTHER.items():
        part, field = path.split(".")
        value = getattr(getattr(model.axes.ra, part), field).value * factor
        model = with_value(model, f"axes.ra.{path}", value)
    return with_inertia(model, 1.3)


OTHER = {
    "friction.coulomb": 1.2,
    "friction.stiction": 0.85,
    "friction.viscous": 1.4,
    "friction.stribeck_rate": 1.3,
    "friction.stribeck_exponent": 1.3,
    "friction.bristle_damping": 0.5,
    "motor.torque_constant": 0.93,
    "motor.resistance": 1.15,
    "gear.damping": 0.7,
}


@pytest.mark.slow
@pytest.mark.parametrize(("preload", "begin"), [("low", STARTS[1]), ("high", STARTS[6])])
def test_E7_and_E8_find_the_numbers_of_a_plant_that_nobody_tuned_them_on(preload, begin):
    plants = {name: other(name) for name in ("low", "high")}
    benches = Benches(CompiledBench, plants, begin)
    noise = Noise(7, "other")
    noise.constant = 1.0
    _, fit = friction_map(benches, preload, noise)
    truth = plants[preload].axes.ra.friction
    assert fit is not None
    assert fit.stiction == pytest.approx(truth.stiction.si, rel=0.10)
    assert fit.viscous == pytest.approx(truth.viscous.si, rel=0.10)
    assert fit.coulomb == pytest.approx(truth.coulomb.si, rel=0.20)
    assert fit.stribeck_rate == pytest.approx(truth.stribeck_rate.si, rel=0.20)
    if preload == "low":
        setpoints = [way * speed for speed in RUN_DOWN_SPEEDS for way in (1, -1)]
        logs = [noise.log(run_down(benches("low"), setpoint)) for setpoint in setpoints]
        inertia = fit_run_downs(logs, setpoints, fit, drive(plants["low"])).inertia
        assert inertia == pytest.approx(1.3 * INERTIA, rel=0.05)


def test_E7_half_the_current_ripple_is_taken_off_the_peaks():
    # D = 0.25: ripple 0.4 A * 0.25 * 0.75 = 75 mA above the mean; counter motor D = 0.025
    mean_a, mean_b = 1.0, 0.2
    n = 10
    log = dataclasses.replace(
        log_of(np.full(n, 600.0), effort=np.full(n, 750.0), current=np.full(n, mean_a + 0.4 * 0.25 * 0.75)),
        adc_b=np.full(n, (mean_b + 0.4 * 0.025 * 0.975) / ADC_A_PER_COUNT),
    )
    torque = drive_torque(log, dataclasses.replace(SHEET, ripple=0.4))
    assert torque == pytest.approx(np.full(n, (mean_a - mean_b) * K * GEAR_RATIO))


@pytest.mark.slow
@pytest.mark.parametrize("make", [CompiledBench, EmulatorBench])
def test_E10_the_model_of_a_drive_does_not_depend_on_where_in_its_gears_it_begins(make):
    """From four starts that no row uses: as the same drive has it whose gears run true."""
    plant = other("low")
    smooth = with_effects(plant, "ra", tuple(e for e in plant.axes.ra.effects if "gear" not in e.name))
    wanted = identify(lambda: make(smooth, 1, None, Start(180.0, 1).steps))
    for begin in (Start(101.9, 4), Start(139.2, 5), Start(188.8, 6), Start(251.5, 7)):
        found = identify(lambda begin=begin: make(plant, begin.seed, None, begin.steps))
        assert found.gain == pytest.approx(wanted.gain, rel=0.03)
        assert found.lag_s == pytest.approx(
            wanted.lag_s, rel=0.05
        )  # a rule takes the gain from it as a share
        assert found.dead_s == pytest.approx(wanted.dead_s, abs=0.002)
