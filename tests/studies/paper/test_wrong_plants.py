"""Plants that must miss a row: the compiled loop with something of the telescope changed."""

from dataclasses import replace

import pytest

from plant.model import load, with_effects, with_value
from plant.parts import Number
from scenarios.studies.options import HIGH, LOW
from scenarios.studies.paper.experiments import EXPERIMENTS
from scenarios.studies.paper.starts import QUICK, Benches, viscous_only, with_inertia
from tests.studies.paper.compiled import CompiledBench
from tests.studies.paper.objective import SCALE
from tests.studies.paper.statics import stall_current

pytestmark = pytest.mark.slow

PLANTS = {"low": load(LOW), "high": load(HIGH)}
BY_ID = {row.id: row for row in EXPERIMENTS}


def figures(name, **changed):
    return BY_ID[name].measure(Benches(CompiledBench, PLANTS | changed, QUICK[0]))


def missed(name, found):
    return {
        limit.figure for limit in BY_ID[name].limits if not limit.holds(found.get(limit.figure, float("nan")))
    }


def with_gains(model, factor):
    for name in ("kp", "ki"):
        model = with_value(model, f"controller.{name}", getattr(model.controller, name).value * factor)
    return model


def with_effect(model, name, factor):
    """Return a model with one effect's amplitude multiplied."""
    effects = []
    for effect in model.axes.ra.effects:
        if effect.name == name:
            amplitude = effect.parameters["amplitude"]
            number = Number(amplitude.value * factor, amplitude.unit, "test")
            effect = replace(effect, parameters=effect.parameters | {"amplitude": number})
        effects.append(effect)
    return with_effects(model, "ra", tuple(effects))


def test_E1_gains_that_are_far_too_high():
    assert "peak" in missed("E1", figures("E1", low=with_gains(PLANTS["low"], 30.0)))


def test_E2_low_preload_or_no_coulomb_friction_is_no_stick_slip():
    for plant in (PLANTS["low"], viscous_only(PLANTS["high"])):
        assert {"peak", "high"} & missed("E2", figures("E2", high=plant))


def test_E3_a_mesh_ten_times_as_rough():
    assert missed("E3", figures("E3", low=with_effect(PLANTS["low"], "gear_mesh", 10.0)))


def test_E3_no_gears_at_all_is_too_good():
    bare = with_effects(PLANTS["low"], "ra", ())
    assert {limit.figure for limit in BY_ID["E3"].limits if limit.figure.startswith("peak")} & missed(
        "E3", figures("E3", low=bare)
    )


def test_E4_a_mesh_a_hundred_times_as_rough():
    assert missed("E4", figures("E4", low=with_effect(PLANTS["low"], "gear_mesh", 100.0)))


def test_E5_gears_five_times_as_eccentric():
    assert missed("E5", figures("E5", low=with_effect(PLANTS["low"], "gear_eccentricity", 5.0)))


def test_E6_without_stribeck_friction_every_speed_is_reached():
    assert missed("E6", figures("E6", low=viscous_only(PLANTS["low"])))


def test_E7_a_plant_with_another_table():
    other = with_value(PLANTS["low"], "axes.ra.friction.viscous", 6700.0 * 1.5)
    assert "low viscous" in missed("E7", figures("E7", low=other))


def test_E8_another_inertia_is_found_and_misses_the_row():
    found = figures("E8", low=with_inertia(PLANTS["low"], 1.25))
    assert found["off 1"] == pytest.approx(25.0, abs=5.0)
    assert "off 1" in missed("E8", found)


def test_E9_gains_that_make_the_real_drive_swing_are_not_the_linear_models():
    shaken = with_gains(PLANTS["low"], 10.0)
    assert "difference" in missed("E9", figures("E9", low=shaken))


def test_E10_gains_ten_times_as_high_are_no_rules():
    assert "second" in missed("E10", figures("E10", low=with_gains(PLANTS["low"], 10.0)))


def test_E11_an_axis_without_coulomb_friction_never_sticks():
    assert "most" in missed("E11", figures("E11", low=viscous_only(PLANTS["low"])))


def test_E12_high_preload_friction_is_another_slope():
    assert "slope" in missed("E12", figures("E12", low=PLANTS["high"]))


def test_E13_no_integral_action_is_a_lasting_error():
    model = with_value(PLANTS["low"], "controller.ki", 1e-4)
    assert "worst" in missed("E13", figures("E13", low=model))


def test_E14_the_stall_current_is_what_the_statics_say():
    model = PLANTS["high"]
    for ohm in (model.axes.ra.motor.resistance.value, 2.6):
        other = with_value(model, "axes.ra.motor.resistance", ohm)
        motor = other.axes.ra.motor
        drive = {"torque_constant": motor.torque_constant.si, "resistance": motor.loop}
        assert figures("E14", high=other)["stall"] == pytest.approx(stall_current(drive, SCALE), rel=0.08)


def test_E15_gains_that_shake_the_high_preload():
    shaken = {preload: with_gains(plant, 30.0) for preload, plant in PLANTS.items()}
    assert missed("E15", figures("E15", **shaken))
