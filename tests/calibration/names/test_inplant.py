"""A finding's numbers in a plant file: within its bounds, by its names, and what is said of the rest."""

import numpy as np
import pytest

from calibration.finding import Finding, Parameter
from calibration.names import NAMES
from calibration.names.inplant import SIDES, Facts, Made, as_found, motor_of, value
from plant.effects import REGISTRY
from plant.gears import RATIO
from plant.model import default_files, load

FACTS = Facts("a.log")
DRAG = REGISTRY["brake_drag"]


def drag(**sizes: float) -> Finding:
    return Finding("brake_drag", "T", "time", parameters={k: Parameter(v, "") for k, v in sizes.items()})


def test_a_number_within_its_bounds_is_written_as_it_is() -> None:
    made = as_found(drag(torque=2.0, start=5.0), FACTS)
    (effect,) = made.effects
    assert made.remarks == [] and effect.name == "brake_drag"
    assert {k: n.value for k, n in effect.parameters.items()} == {"torque": 2.0, "start": 5.0}
    assert effect.parameters["torque"].source == "fitted to a.log"
    assert effect.harmonic == 1 and effect.stage is None


def test_a_number_beyond_its_bounds_is_written_as_the_bound_and_told() -> None:
    high = next(p for p in DRAG.parameters if p.name == "torque").high
    made = as_found(drag(torque=2.0 * high), FACTS)
    assert made.effects[0].parameters["torque"].value == high
    (remark,) = made.remarks
    assert remark.startswith("brake_drag: torque") and f"written as {high:.4g}" in remark
    close = as_found(drag(torque=high * (1 + 1e-10)), FACTS)  # rounding is none
    assert close.remarks == [] and close.effects[0].parameters["torque"].value == high
    assert as_found(drag(torque=high * (1 + 1e-8)), FACTS).remarks


def test_a_phase_is_written_within_a_turn_and_an_unfound_size_as_nothing() -> None:
    line = Finding("gear_mesh", "T", "axis_angle", stage="mesh3", harmonic=2)
    made = Made().added(line, FACTS, phase=2 * np.pi + 0.5)
    (effect,) = made.effects
    assert effect.parameters["phase"].value == pytest.approx(0.5) and made.remarks == []
    assert effect.parameters["amplitude"].value == 0.0
    assert effect.parameters["amplitude"].source == "not found in a.log"
    assert (effect.stage, effect.harmonic) == ("mesh3", 2)


def test_what_no_plant_knows_is_left_out_and_a_note_is_kept() -> None:
    f = drag(torque=1.0, strange=3.0).noted("seen twice")
    made = as_found(f, FACTS)
    assert set(made.effects[0].parameters) == {"torque"} and made.remarks == ["brake_drag: seen twice"]


def test_an_onset_of_every_run_is_the_plants_own() -> None:
    made = as_found(drag(torque=1.0, start_in_run=7.0), FACTS)
    assert made.effects[0].parameters["start"].value == 7.0
    assert made.remarks == ["brake_drag: it comes in every run, the plant has it from its own start on"]


def test_a_function_is_a_smooth_one_unless_it_says_otherwise() -> None:
    made = Made()
    made.function("torque", "time", [(0.0, 1.0), (1.0, 2.0)], "seen")
    made.function("torque", "time", [(0.0, 1.0)], "seen", period=3.0, interpolation="linear")
    one, two = (e.function for e in made.effects)
    assert one is not None and two is not None
    assert (one.interpolation, one.period, one.knots) == ("cubic", 0.0, ((0.0, 1.0), (1.0, 2.0)))
    assert (two.interpolation, two.period) == ("linear", 3.0)
    assert {e.name for e in made.effects} == {"unknown"}


def test_a_parameter_that_is_not_there_is_nothing_or_what_is_asked_for() -> None:
    f = drag(torque=4.0, motor=2.0)
    assert (value(f, "torque"), value(f, "start"), value(f, "start", 9.0)) == (4.0, 0.0, 9.0)
    assert (motor_of(f), motor_of(drag())) == (2, 0)


def test_without_a_log_the_facts_are_the_low_preload_plants_and_nothing_moves() -> None:
    motor = load(default_files()["low_preload"]).axes.ra.motor
    assert pytest.approx(motor.loop, rel=0.01) == FACTS.resistance
    assert pytest.approx(motor.resistance.si) == FACTS.winding
    assert pytest.approx(motor.torque_constant.si * RATIO, rel=0.01) == FACTS.per_ampere
    assert FACTS.supply == 24.0  # V, of its amplifiers
    assert (FACTS.middle, FACTS.span, FACTS.half_play, FACTS.warming, FACTS.duration_s) == (0, 0, 0, 0, 1)


@pytest.mark.parametrize(("stage", "quarter"), [("axis", -0.25), ("roller", 0.25)])
def test_an_error_of_the_absolute_encoder_is_subtracted_and_of_the_roller_added(
    stage: str, quarter: float
) -> None:
    """cos(x + p) is minus the sine of x + p - 90 degrees, or the sine of x + p + 90 degrees."""
    f = Finding("encoder_eccentricity", "K", "axis_angle", stage=stage, harmonic=1)
    f = f.having(amplitude=Parameter(2.0, "arcsec"), phase=Parameter(0.3, "rad"))
    (effect,) = NAMES["encoder_eccentricity"].to_plant(f, FACTS).effects
    assert effect.parameters["phase"].value == pytest.approx(0.3 + 2 * np.pi * quarter)


def test_a_motors_angle_lies_half_the_play_off_the_axis_one_each_way() -> None:
    assert SIDES == (0.0, 1.0, -1.0)  # both, A, B


def test_an_angle_that_is_no_phase_is_not_turned_back() -> None:
    made = Made().add("cable_wrap", FACTS, {"centre": 5.0})  # rad, more than half a turn
    assert made.effects[0].parameters["centre"].value == 5.0 and made.effects[0].harmonic == 1


def test_a_number_beside_nothing_is_compared_with_what_it_is() -> None:
    """A bound of 0: what is a millionth below it is beyond."""
    made = Made().add("brake_drag", FACTS, {"duration": -1e-6})
    low = next(p for p in DRAG.parameters if p.name == "duration").low
    assert low == 0.0 and made.effects[0].parameters["duration"].value == 0.0 and len(made.remarks) == 1
