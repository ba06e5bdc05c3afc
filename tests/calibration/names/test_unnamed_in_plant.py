"""What an effect without a name is in a plant file."""

from typing import Any

import numpy as np
import pytest

from calibration.finding import UNKNOWN, Curve, Finding, Parameter
from calibration.names import unnamed
from tests.calibration.names.test_weights_and_cables import FACTS


def plant(
    channel: str, domain: str, frequency: float | None = None, curve: Curve | None = None, **sizes: Any
) -> Any:
    given = {
        k: v if isinstance(v, Parameter) else Parameter(v, "N m", v - 0.5, v + 0.5) for k, v in sizes.items()
    }
    f = Finding(UNKNOWN, channel, domain, frequency=frequency, curve=curve, parameters=given)
    return unnamed.to_plant(f, FACTS)


def function(made: Any) -> Any:
    (effect,) = made.effects
    return effect.function


def test_a_curve_enters_the_plant_with_its_uncertainty() -> None:
    curve = Curve("velocity", "N m", (0.0, 1.0, 2.0), (3.0, 4.0, 5.0), (0.1, 0.2, 0.9))
    f = function(plant("T", "velocity", curve=curve))
    assert f.knots == ((0.0, 3.0), (1.0, 4.0), (2.0, 5.0)) and (f.target, f.domain) == ("torque", "velocity")
    assert f.source == "fitted to log; 95 % within +-0.2 N m, at worst +-0.9 N m"


def test_loops_and_waves_act_against_what_the_motors_give() -> None:
    loops = function(plant("T", "reversal", loop_1=4.0, loop_3=6.0))
    assert loops.knots == ((1e-3, -4.0), (8e-3, -6.0)) and loops.interpolation == "stop"
    assert loops.source == "fitted to log; heights 95 % within +-0.5 N m"
    one = function(plant("T", "reversal", loop=4.0, travel=0.02))
    assert one.knots == ((0.02, -4.0),)
    wave = function(plant("T", "time", 0.25, amplitude=2.0, phase=0.3, amplitude_2=1.0, phase_2=0.1))
    x, y = np.array(wave.knots).T
    w = 2 * np.pi * x / 4
    assert (
        y == pytest.approx(-(2 * np.cos(w + 0.3) + np.cos(2 * w + 0.1)))
        and x[-1] == 4.0
        and wave.period == 4.0
    )
    assert y[-1] == y[0] and wave.source.endswith("whose first row is time 0; 95 % within +-0.71 N m")


def test_lines_of_volts_are_a_brush_or_a_current() -> None:
    ohm = function(plant("E", "motor_angle", amplitude=Parameter(0.2, "ohm"), motor=1.0))
    x, y = np.array(ohm.knots).T
    assert ohm.target == "resistance" and y == pytest.approx(0.2 * np.cos(x - 0.01)) and ohm.motor == 1
    volt = function(plant("E", "motor_angle", amplitude=Parameter(0.2, "V")))
    assert volt.target == "command" and volt.knots[0][1] == pytest.approx(-0.2 / 24)
    made = plant("E", "time", 50.0, amplitude=0.3)
    x, y = np.array(function(made).knots).T
    assert (
        y == pytest.approx(0.3 * np.sin(2 * np.pi * 50 * x), abs=1e-9) and function(made).target == "current"
    )
    assert made.remarks == ["unknown on the currents: size and frequency are the log's, its phase is none"]


def test_what_no_plant_can_hold_is_left_out_and_said() -> None:
    law = plant("S", "command")
    assert law.effects == [] and law.remarks == [
        "unknown on the command: left out of the plant, it is the controller's law that differs, and the "
        "plant file has one set of gains and no set point"
    ]
    other = plant("K", "axis_angle")
    assert other.effects == [] and other.remarks == [
        "unknown over axis angle in channel K: left out, the report gives no function of a signal that the "
        "plant has"
    ]
