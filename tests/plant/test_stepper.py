"""The focus motor with currents and load (P11), the LVDT with its carrier (P12), against the fast ones."""

from itertools import pairwise
from math import cos, pi

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from plant.focus import FocusPort
from plant.model import load
from tests.plant.lvdt import FILTER_S, CarrierLvdt, ripple
from tests.plant.stepper import Motor, MotorFocusPort, Stepper

MS = 1_000_000
MODEL = load().focus
MOTOR = Motor()


def walk(port: FocusPort, count: int, period_ns: int) -> float:
    """Step from phase 0, wait, and say where it is."""
    t_ns, phase = 0, 0
    port.coils(0, 0, True, False)
    for _ in range(abs(count)):
        t_ns += period_ns
        phase += 1 if count > 0 else -1
        port.coils(t_ns, phase % 8, True, False)
    return port.position(t_ns + 300 * MS)


@settings(max_examples=10, deadline=None)
@given(st.integers(-40, 40))
def test_P11_the_motor_ends_where_the_kinematic_one_does(count: int) -> None:
    slack = 4 / pi * MOTOR.friction / MOTOR.holding * 2**0.5  # half steps the friction leaves, one coil on
    assert walk(MotorFocusPort(MODEL), count, 5 * MS) == pytest.approx(
        walk(FocusPort(MODEL), count, 5 * MS), abs=1.2 * slack
    )


def test_P11_currents_are_ohms_law_and_the_time_constant_is_l_over_r() -> None:
    motor = Stepper(MOTOR, 0.0)
    motor.drive(0, 0, True, False)
    tau_ns = round(MOTOR.inductance / MOTOR.resistance * 1e9)
    motor.advance(tau_ns)
    assert motor.current_a == pytest.approx(1.2 * (1 - 2.718281828**-1), rel=0.02)  # steps of tau/75
    motor.advance(20 * tau_ns)
    assert motor.current_a == pytest.approx(1.2, rel=1e-3)


@pytest.mark.parametrize(("share", "holds"), [(0.5, True), (0.95, True), (1.1, False)])
def test_P11_a_load_beyond_the_holding_torque_turns_the_rotor_back(share: float, holds: bool) -> None:
    """One coil on: the rotor holds 1/sqrt 2 of what two hold, at 90 electrical degrees."""
    one_coil = MOTOR.holding / 2**0.5
    port = MotorFocusPort(MODEL, 0.0, load=0.0)
    port.coils(0, 0, True, False)
    port.position(50 * MS)
    load_nm = share * one_coil + (0 if holds else MOTOR.friction)
    port.motor.load = load_nm
    port.motor.resting = False
    at = port.position(400 * MS)
    assert (abs(at) < 2.0) is holds, "two half steps are 90 degrees"


def test_P11_a_load_below_pull_out_costs_no_step_and_one_above_costs_whole_cycles() -> None:
    for share, lost in ((0.3, False), (0.9, True)):
        port = MotorFocusPort(MODEL, load=share * MOTOR.holding / 2**0.5)
        at = walk(port, 80, 5 * MS)
        behind = 80 - at
        assert (behind > 4) is lost, share
        if lost:
            # poles are eight half steps apart; the load leaves the rotor up to two behind its own
            assert min(behind % 8, 8 - behind % 8) < 2.5 or behind > 80


def test_P11_stepping_beyond_the_pull_out_rate_loses_steps() -> None:
    assert walk(MotorFocusPort(MODEL), 160, 5 * MS) == pytest.approx(160, abs=0.2)
    assert abs(walk(MotorFocusPort(MODEL), 160, MS // 5) - 160) > 4


@pytest.mark.parametrize("hold", [True, False])
def test_P11_an_unpowered_motor_stays_under_load(hold: bool) -> None:
    port = MotorFocusPort(MODEL, load=0.2)
    at = walk(port, 5, 10 * MS)
    port.coils(400 * MS, 0, False, hold)
    assert port.position(5000 * MS) == pytest.approx(at, abs=0.3)


def test_who_looks_and_how_often_changes_nothing() -> None:
    often, once = MotorFocusPort(MODEL), MotorFocusPort(MODEL)
    for port in (often, once):
        port.coils(0, 3, True, False)
    for t_ns in range(0, 50 * MS, 777_777):
        often.position(t_ns)
    assert often.position(50 * MS) == once.position(50 * MS)


def test_P12_the_rectified_carrier_settles_on_the_ideal_voltage_with_its_ripple() -> None:
    lvdt = CarrierLvdt(lambda t_ns: 2.5 if t_ns < 10 * MS else 4.0)
    assert lvdt(5 * MS) == pytest.approx(2.5)
    seen = [lvdt(t_ns) for t_ns in range(110 * MS, 112 * MS, 12_500)]
    mean = sum(seen) / len(seen)
    assert mean == pytest.approx(4.0, abs=1e-4)  # a fiftieth of an ADC count
    assert (max(seen) - min(seen)) / 2 == pytest.approx(ripple(1.5), rel=0.1)
    assert ripple(1.5) < 5.0 / 1024, "less than a count of the ADC"


def test_P12_the_filter_lags_by_its_two_time_constants() -> None:
    slope = 10.0  # V/s
    lvdt = CarrierLvdt(lambda t_ns: 2.5 + slope * t_ns * 1e-9)
    lvdt(0)
    lag = [2.5 + slope * t * 1e-9 - lvdt(t) for t in range(95 * MS, 96 * MS, 25_000)]
    assert sum(lag) / len(lag) == pytest.approx(slope * 2 * FILTER_S, rel=0.03)


@pytest.mark.parametrize("phase", [0.2, 0.5])
def test_P12_a_phase_error_costs_its_cosine(phase: float) -> None:
    lvdt = CarrierLvdt(lambda _t: 4.0, phase_rad=phase)
    seen = [lvdt(t_ns) for t_ns in range(150 * MS, 152 * MS, 12_500)]
    assert sum(seen) / len(seen) - 2.5 == pytest.approx(1.5 * cos(phase), rel=5e-3)


def test_P12_the_sign_of_the_secondary_is_the_side_of_the_middle() -> None:
    right, left = CarrierLvdt(lambda _t: 3.0), CarrierLvdt(lambda _t: 2.0)
    quarter = 125_000  # ns, a quarter of the carrier's period
    assert right.secondary(quarter) == pytest.approx(0.5 * pi / 2)
    assert left.secondary(quarter) == pytest.approx(-0.5 * pi / 2)
    signs = [right.secondary(t) > 0 for t in range(quarter, 20 * quarter, 2 * quarter)]
    assert all(a != b for a, b in pairwise(signs))
