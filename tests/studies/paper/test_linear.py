import pytest

from plant.model import load, with_value
from scenarios.studies.paper.experiments.models import LinearAxis, linear_axis, simulate_loop
from scenarios.studies.paper.scales import ARCSEC, GEAR_RATIO

# hardware.md 2.3, the first set, with L = R * 2 ms: poles -15.4 and -488 1/s, 1.91 counts per PWM step
S1 = LinearAxis(
    torque_constant=0.78, resistance=4.0, inductance=0.008, inertia=1760.0 / GEAR_RATIO**2,
    viscous=6700.0 / GEAR_RATIO**2, stiction=621.0 / GEAR_RATIO, voltage=24.0, drive=1.0,
)  # fmt: skip


def test_E9_the_loop_settles_on_the_set_point_and_holds_the_effort_of_the_statics():
    rate, effort = simulate_loop(S1, (0.9, 0.07), 3000, 3.0)
    assert rate.size == 600  # periods of 5 ms
    assert rate[-1] == pytest.approx(600.0, rel=1e-3)
    motor = 600.0 * ARCSEC * GEAR_RATIO
    volt = (
        S1.stiction + S1.viscous * motor
    ) * S1.resistance / S1.torque_constant + S1.torque_constant * motor
    assert effort[-1] == pytest.approx(volt / 24.0 * 3000, rel=1e-3)


def test_E9_without_gain_the_axis_stays_where_it_is():
    rate, _ = simulate_loop(S1, (0.0, 0.0), 3000, 0.5)
    assert not rate.any()


def test_E9_the_axis_of_a_plant_file_is_reflected_to_the_motor():
    model = with_value(load("low_preload"), "axes.ra.friction.viscous", 6700.0)
    axis = linear_axis(model)
    assert axis.viscous * GEAR_RATIO**2 == pytest.approx(6700.0)
    assert axis.drive == pytest.approx(1.0 - model.controller.counter_split.si)
