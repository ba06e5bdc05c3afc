import numpy as np
import pytest

from plant.model import load
from scenarios.paper.cost import outside
from scenarios.paper.linear import linear_axis, reduce_to_dead_time
from scenarios.paper.proposals import as_points, draw
from scenarios.paper.published import INERTIA, TABLE_2
from scenarios.paper.scales import ARCSEC, GEAR_RATIO
from scenarios.paper.screen import Axis, open_loop_room, rule_gains, spectral_radius
from scenarios.paper.space import SPACE, models, values, vector
from scenarios.paper.statics import shortfalls, stribeck_slope
from scenarios.paper.tuning import simc

BASES = {"low": load("low_preload"), "high": load("high_preload")}
DRIVE = {
    "bristle_stiffness": 8e6,
    "stiffness_ratio": 3.0,
    "bristle_damping": 0.5,
    "exponent": 1.0,
    "torque_constant": 0.65,
    "resistance": 1.6,
    "electrical_time": 1e-3,
    "rotor_inertia": 4e-4,
    "gear_damping": 9e3,
    "closed_time": 0.02,
    "twice": 10.0,
    "once": 2.0,
    "mesh": 3.0,
    "imbalance": 30.0,
}


def test_a_vector_and_its_values_are_each_others_inverse():
    assert values(vector(DRIVE)) == pytest.approx(DRIVE)


def test_both_preloads_share_the_drive_and_the_controller_and_keep_table_2():
    found = models(BASES, DRIVE, "test")
    low, high = found["low"], found["high"]
    assert low.controller == high.controller
    assert low.axes.ra.motor == high.axes.ra.motor
    assert low.axes.ra.effects == high.axes.ra.effects
    for preload, model in found.items():
        friction = model.axes.ra.friction
        assert friction.coulomb.si == TABLE_2[preload]["coulomb"]
        assert friction.stiction.si == TABLE_2[preload]["stiction"]
        assert friction.viscous.si == TABLE_2[preload]["viscous"]
        total = model.axes.ra.inertia.si + 2.0 * model.axes.ra.motor.rotor_inertia.si * GEAR_RATIO**2
        assert total == pytest.approx(INERTIA, abs=0.1)


def test_every_fitted_number_says_where_it_comes_from():
    model = models(BASES, DRIVE, "fitted by a test")["low"]
    assert model.axes.ra.motor.torque_constant.source == "fitted by a test"
    assert model.axes.ra.friction.coulomb.source != "fitted by a test"


def test_E10_the_batch_of_gains_is_the_rule_applied_to_equation_6():
    # found twice: by screen.py for a batch, by linear.py and tuning.py from the plant model
    random = np.random.default_rng(5)
    x = draw(random, 8)
    points = as_points(x)
    kp, ki = rule_gains(Axis(points, 1.0))
    for k in range(8):
        plant = models(BASES, values(x[k]), "test")["low"]
        rule = simc(reduce_to_dead_time(linear_axis(plant), 3000), points["closed_time"][k])
        assert (kp[k], ki[k]) == pytest.approx((rule.kp, rule.ki), rel=5e-3)


def test_E6_room_in_open_loop_is_the_work_of_the_torque_balance():
    axis = Axis({name: np.array([value]) for name, value in (DRIVE | {"torque_constant": 1.1}).items()}, 1.0)
    room, fold = open_loop_room(axis, 300.0)
    motor = (1.1 * GEAR_RATIO) ** 2 / DRIVE["resistance"]

    def surplus(rate):
        friction = 229.0 + 392.0 * np.exp(-rate / 4e-4) + 6700.0 * rate
        return motor * rate + friction

    at = np.linspace(10.0, 300.0, 3000) * ARCSEC
    low = at[np.argmin(surplus(at))]
    assert fold[0] == pytest.approx(low / ARCSEC, abs=6.0)
    assert room[0] == pytest.approx(surplus(300.0 * ARCSEC) - surplus(low), rel=0.1)


def test_stribeck_slope_is_the_derivative_of_the_curve():
    for exponent in (0.5, 1.0, 2.0):
        w, h = 3e-4, 1e-9
        drop = [392.0 * np.exp(-((v / 4e-4) ** exponent)) for v in (w - h, w + h)]
        assert stribeck_slope(w, exponent, 392.0, 4e-4) == pytest.approx(
            (drop[0] - drop[1]) / (2 * h), rel=1e-3
        )


def test_statics_know_a_drive_that_cannot_reach_3_degrees_per_second():
    assert shortfalls(DRIVE)["reaches 3 deg/s at 24 V"] == 0.0
    assert shortfalls(DRIVE | {"torque_constant": 1.24})["reaches 3 deg/s at 24 V"] > 0.0


def test_spectral_radius_of_a_loop_without_gain_is_the_axis_own():
    axis = Axis({name: np.array([value]) for name, value in DRIVE.items()}, 1.0)
    none = (np.zeros(1), np.zeros(1))
    # the effort's integrator stays at one; the sliding axis at 600 arcsec/s decays
    assert spectral_radius(axis, "low", none, 600.0 * ARCSEC)[0] == pytest.approx(1.0, abs=1e-9)
    # at 15 arcsec/s friction falls faster than the motor's torque: unstable in open loop
    assert spectral_radius(axis, "low", none, 15.0 * ARCSEC)[0] > 1.001


def test_distance_to_a_band():
    assert outside(5.0, 2.0, 7.0, 1.0) == 0.0
    assert outside(8.0, 2.0, 7.0, 0.5) == pytest.approx(2.0)
    assert outside(0.0, 2.0, 7.0, 1.0) == pytest.approx(2.0)
    assert outside(1e9, 2.0, 7.0, 1.0, limit=5.0) == 5.0


def test_every_free_number_has_bounds_and_a_reason():
    assert all(0.0 < free.low < free.high and free.why and free.unit for free in SPACE)
