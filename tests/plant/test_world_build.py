"""The world of both axes from a plant model: what of it goes into which row."""

import numpy as np
import pytest

from plant.kernels import layout as at
from plant.model import with_effects, with_value
from plant.parts import EffectModel, Number, PlantModel
from plant.stops import with_stops
from plant.units import ARCSEC
from plant.world import AXES, PATHS, build, declared, grid_ns, numbers_of
from tests.plant.bench import bare, changed, switching


def effect(name: str, **given: float) -> EffectModel:
    units = {"share": "1", "drop": "V", "compliance": "arcsec/(N m)", "inertia": "kg m2"}
    return EffectModel(name, parameters={word: Number(v, units[word], "") for word, v in given.items()})


def of_ra(*effects: EffectModel) -> PlantModel:
    return with_effects(bare(), "ra", effects)


def test_a_grid_step_is_rounded_to_nanoseconds() -> None:
    assert grid_ns(bare()) == 500_000
    assert grid_ns(with_value(bare(), "numerics.grid", 333.3336)) == 333_334


def test_every_axis_has_its_own_row() -> None:
    """Table 1: 3.08e9 and 2.46e9 N mm/rad of both trains, half of it each."""
    world = build(bare(), 1, {"dec": 0.5})
    assert world.shape == (2, at.WIDTH) and AXES == ("ra", "dec")
    assert world[:, at.GEAR_STIFFNESS] == pytest.approx([1.54e6, 1.23e6])
    assert world[:, at.ANGLE].tolist() == [0.0, 0.5]
    assert not world[:, at.SUPPLY_RESISTANCE].any()
    soft = build(with_value(bare(), "supply.resistance", 0.3), 1, {})
    assert soft[:, at.SUPPLY_RESISTANCE].tolist() == [0.3, 0.3]


def test_declared_numbers_are_found_by_their_paths() -> None:
    model = bare()
    found = declared(model, "dec")
    assert set(found) == set(PATHS) and len(found) == 30
    assert found["stiffness"] is model.axes.dec.gear.stiffness
    assert found["grid"] is model.numerics.grid and found["drag"] is model.axes.dec.motor.drag


def test_where_counters_wake_up_is_a_share_of_a_count_by_seed_and_axis() -> None:
    made = {(axis, seed): numbers_of(bare(), axis, seed, 0.0) for axis in AXES for seed in (1, 2)}
    shares = [x for n in made.values() for x in (n.incremental_phase, n.phase_a, n.phase_b)]
    assert len(set(shares)) == 12 and all(0.0 < share < 1.0 for share in shares)
    assert max(shares) > 0.6 and min(shares) < 0.4


def test_effects_change_constants_of_the_axis_once_and_add_up() -> None:
    still = numbers_of(of_ra(), "ra", 1, 0.0)
    assert (still.diode, still.diode_drop, still.compliance, still.swinging) == (0.0, 0.0, 0.0, 0.0)
    model = of_ra(
        effect("shaft_compliance", compliance=0.1),
        effect("shaft_compliance", compliance=0.3),
        effect("structural_mode", inertia=150.0),
        effect("diode_braking", share=0.25, drop=0.6),
    )
    made = numbers_of(model, "ra", 1, 0.125)
    assert made.compliance == pytest.approx(0.4 * ARCSEC)
    assert (made.swinging, made.diode, made.diode_drop, made.angle) == (150.0, 0.25, 0.6, 0.125)
    off = EffectModel("structural_mode", enabled=False)
    assert numbers_of(of_ra(off), "ra", 1, 0.0).swinging == 0.0


def test_a_power_stage_is_solved_where_its_diode_is_declared() -> None:
    assert numbers_of(bare(), "ra", 1, 0.0).stage_drop == 0.0
    assert numbers_of(switching("low_preload", 0.8), "dec", 1, 0.0).stage_drop == 0.8


def test_what_swings_is_less_than_the_axis() -> None:
    swing = effect("structural_mode", inertia=1000.0)
    build(with_effects(changed(bare(), inertia=1000.5), "ra", (swing,)), 1, {})
    for inertia in (1000.0, 999.0):
        with pytest.raises(ValueError, match=r"axes\.ra\.effects: more swings than the axis' inertia"):
            build(with_effects(changed(bare(), inertia=inertia), "ra", (swing,)), 1, {})


def test_stops_are_a_middle_and_a_reach() -> None:
    world = build(with_stops(bare(), {"dec": (1.0, 2.5)}), 1, {})
    beyond = np.radians(5.0)
    assert world[1, at.STOP_MIDDLE] == pytest.approx(1.75)
    assert world[1, at.STOP_REACH] == pytest.approx(0.75 + beyond)
    assert (world[1, at.STOP_STIFFNESS], world[1, at.STOP_DAMPING]) == (4e5, 1.6e4)
    assert not world[0, at.STOP_MIDDLE : at.STOP_DAMPING + 1].any()
