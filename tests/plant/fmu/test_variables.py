"""Numbers and switches of an exported axis, by the plant file that it is made of: units, bounds, places."""

from dataclasses import replace
from math import pi

import pytest

from plant import model
from plant.fmu import variables as has
from plant.fmu.variables import Parameter, base_unit, exported
from plant.parts import EffectModel, Number
from plant.world import Numbers
from tests.plant.fmu.sample import DECLARED, EFFECTS, axis

RATIO = 113 / 27 * 123 / 21 * 250 / 17
ARCSEC = pi / 648_000


def by_name() -> dict[str, Parameter]:
    return {each.name: each for each in axis().parameters if each.name}


def test_every_number_of_the_axis_comes_first_in_its_order() -> None:
    made = axis()
    assert len(Numbers._fields) == DECLARED
    assert [has.NUMBER_OF[name] for name in Numbers._fields] == list(range(DECLARED))
    names = [each.name.rpartition(".")[2] for each in made.parameters[:DECLARED]]
    assert names[:30] == list(Numbers._fields[:30])
    assert names[30:] == [""] * 5 + ["start_angle"] + [""] * 3  # of effects and of the start: fixed


def test_a_number_has_its_bounds_in_si_units_and_the_unit_of_its_file() -> None:
    found = by_name()
    assert found["axis.friction.coulomb"][1:5] == (229.0, 0.0, 1e5, "N m")
    backlash = found["axis.gear.backlash"]
    assert backlash.start == pytest.approx(21 * pi / 180 / RATIO) and backlash.unit == "deg motor"
    assert (backlash.low, backlash.high) == (0.0, 0.1)
    assert found["environment.warming"][1:4] == pytest.approx((-1 / 3600, -0.01, 0.01))
    assert found["start_angle"][1:5] == (0.0, -1e300, 1e300, "rad")
    assert found["axis.motor.resistance"].source.startswith("design.md")


def test_bounds_never_exclude_what_the_file_has() -> None:
    """A value may be beyond by a rounding: then it is the bound."""
    base = model.load("low_preload")
    above, below = Number(100.0 * (1 + 1e-12), "V", ""), Number(1.0 * (1 - 1e-12), "V", "")
    for number, low, high in ((above, 1.0, above.si), (below, below.si, 100.0)):
        made = exported(replace(base, supply=replace(base.supply, voltage=number)), "dec", 1)
        assert made.parameters[1][1:4] == (number.si, low, high)


def test_an_effect_s_numbers_follow_with_its_place_in_the_list() -> None:
    made, found = axis(), by_name()
    assert made.of_effects[0] == {"amplitude": DECLARED, "phase": DECLARED + 1}
    assert made.of_effects[1] == {"packet_loss": DECLARED + 2, "repeats": DECLARED + 3}
    assert made.of_effects[2]["amplitude"] == DECLARED + 4
    assert made.of_effects[-1]["width"] == len(made.parameters) - 1
    given = found["effects[0].gear_mesh.amplitude"]
    assert given.start == pytest.approx(0.5 * RATIO) and (given.unit, given.source) == (
        "N mm motor",
        "a test",
    )
    assert (given.low, given.high) == (0.0, given.start)  # 180 N m, and the catalogue has 100
    default = found["effects[2].encoder_eccentricity.amplitude"]
    assert (default.start, default.high) == pytest.approx((2 * ARCSEC, 60 * ARCSEC))
    assert default.unit == "arcsec" and default.source.startswith("hardware.md 1.3")
    width = found["effects[7].cable_wrap.width"]
    assert (width.start, width.low, width.high) == pytest.approx((pi / 360, pi / 180_000, pi / 6))


def test_a_number_below_the_catalogue_s_bound_is_its_own_bound() -> None:
    low = Number(-5.0, "N m", "")
    effect = EffectModel("gear_mesh", "mesh1", parameters={"amplitude": low})
    made = exported(model.with_effects(model.load("low_preload"), "ra", (effect,)), "ra", 1)
    assert made.parameters[DECLARED][1:4] == (-5.0, -5.0, 100.0)


def test_what_says_where_an_effect_acts_is_fixed_and_so_is_all_that_acts_elsewhere() -> None:
    found = by_name()
    assert "effects[6].play.gap" in found and "effects[6].play.encoder" not in found
    assert not any("sample_loss" in name for name in found)
    assert "effects[4].channel_delay.delay" in found  # a reading comes late in the plant
    names = [f"effects[{k}].{each.name}.enabled" for k, each in enumerate(EFFECTS)]
    assert axis().switchable == tuple("" if "sample_loss" in name else name for name in names)
    assert axis().enabled == (True, True, False, True, True, True, True, True)


def test_numbers_are_those_of_the_axis_without_effects_and_at_rest_at_zero() -> None:
    """Changes that effects make once are in their own rows: shaft_compliance is not in the number."""
    numbers = dict(zip(Numbers._fields, axis().parameters[:DECLARED], strict=True))
    assert numbers["compliance"].start == numbers["swinging"].start == numbers["angle"].start == 0.0
    assert 0.0 < numbers["phase_a"].start < 1.0 and numbers["phase_a"].start != numbers["phase_b"].start
    assert axis().part.effects == EFFECTS


def test_a_ratio_has_no_unit() -> None:
    assert (base_unit("%"), base_unit("1"), base_unit("deg"), base_unit("N mm")) == ("", "", "rad", "N m")


def test_references_are_those_of_the_wrapper() -> None:
    first = (has.FIRST_REAL, has.FIRST_COUNTER, has.FIRST_SWITCH, has.FIRST_PARAMETER)
    assert first == (10, 20, 50, 1000)
