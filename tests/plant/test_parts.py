"""Unit and bounds of every number of a plant file, and those that are not given.

Bounds are wide on purpose: a power of ten or two about the machine's own number. They keep out a wrong unit.
"""

from collections.abc import Iterator
from dataclasses import MISSING, fields, is_dataclass
from typing import Any, get_args, get_type_hints

import pytest

from plant import model
from plant.parts import EffectModel, Function, MountErrors, Number, PlantModel, Stops

Bounds = tuple[str, float, float]
NUMBERS: dict[str, dict[str, Bounds]] = {
    "Numerics": {"grid": ("s", 0.00001, 0.002)},
    "Supply": {"voltage": ("V", 1, 100), "resistance": ("ohm", 0, 1)},
    "Environment": {"temperature": ("degC", -60, 60), "warming": ("K/s", -0.01, 0.01)},
    "Controller": {
        "kp": ("steps/count", 0, 100), "ki": ("steps/count", 0, 100), "counter_split": ("1", 0, 1),
        "pwm_steps": ("steps", 16, 2**16), "pwm_frequency": ("Hz", 100, 1_000_000),
        "period": ("s", 0.001, 0.1),
    },
    "Gear": {
        "stiffness": ("N m/rad", 10_000, 1_000_000_000), "damping": ("N m s/rad", 0, 1_000_000),
        "backlash": ("rad", 0, 0.1),
    },
    "Friction": {
        "coulomb": ("N m", 0, 100_000), "stiction": ("N m", 0, 100_000),
        "viscous": ("N m s/rad", 0, 10_000_000), "stribeck_rate": ("rad/s", 0.0000001, 1),
        "stribeck_exponent": ("1", 0.1, 10), "bristle_stiffness": ("N m/rad", 10_000, 10_000_000_000),
        "bristle_damping": ("N m s/rad", 0, 10_000_000), "bristle_decay": ("rad/s", 0, 1),
    },
    "Motor": {
        "torque_constant": ("N m/A", 0.01, 10), "resistance": ("ohm", 0.05, 100),
        "inductance": ("H", 0.00001, 1), "rotor_inertia": ("kg m2", 0.00001, 1),
        "drag": ("N m s/rad", 0, 1), "switch_resistance": ("ohm", 0, 10), "sense_resistance": ("ohm", 0, 10),
        "diode_drop": ("V", 0.01, 1.5),
    },
    "Encoders": {
        "incremental": ("counts/turn", 100, 1_000_000_000), "roller_ratio": ("1", 1, 1000),
        "absolute": ("bit", 8, 32), "auxiliary": ("bit", 8, 32), "auxiliary_ratio": ("1", 0.1, 1000),
        "tachometer": ("counts/turn", 4, 10_000_000),
    },
    "Stops": {
        "low": ("rad", -10, 10), "high": ("rad", -10, 10), "stiffness": ("N m/rad", 10_000, 1_000_000_000),
        "damping": ("N m s/rad", 0, 1_000_000),
    },
    "AxisModel": {"inertia": ("kg m2", 1, 1_000_000)},
    "FocusModel": {
        "half_steps": ("half steps/turn", 4, 100_000), "belt_ratio": ("1", 0.1, 100),
        "screw_lead": ("m/turn", 0.0001, 0.1), "travel": ("m", 0.0001, 1), "settling": ("s", 0.0001, 1),
        "encoder": ("counts/turn", 4, 1_000_000), "index_width": ("counts", 1, 1000),
        "lvdt_full_scale": ("V", 0.1, 100), "lvdt_gain_error": ("1", -0.5, 0.5), "lvdt_offset": ("V", -2, 2),
        "lvdt_nonlinearity": ("1", -0.1, 0.1),
    },
}  # fmt: skip
MOUNT = {
    "hour_angle_index": (240, 3600), "declination_index": (-180, 3600), "polar_azimuth": (90, 3600),
    "polar_altitude": (-120, 3600), "collimation": (60, 1800), "non_perpendicularity": (-30, 1800),
    "tube_flexure": (-20, 300), "fork_flexure": (12, 300), "axis_flexure": (8, 300),
    "hour_angle_eccentricity": (1, 60), "declination_eccentricity": (1, 60), "refraction": (2, 60),
}  # fmt: skip
"""Arcsec: as docs/guides/pointing-model.md has them; and at most, either way."""


def parts(kind: type[Any]) -> Iterator[type[Any]]:
    """A part and those within."""
    yield kind
    inside: list[Any] = [each for hint in get_type_hints(kind).values() for each in get_args(hint) or (hint,)]
    for each in inside:
        if is_dataclass(each) and each not in (Number, EffectModel):
            yield from parts(each)  # type: ignore[arg-type]


def test_every_number_has_its_unit_and_its_bounds() -> None:
    found: dict[str, dict[str, Bounds]] = {}
    for kind in parts(PlantModel):
        numbers = {f.name: tuple(f.metadata.values()) for f in fields(kind) if f.metadata}
        if numbers and kind is not MountErrors:
            found[kind.__name__] = numbers
    assert found == NUMBERS


def test_a_mount_whose_numbers_are_not_given_has_typical_ones() -> None:
    made = MountErrors()
    assert {f.name: getattr(made, f.name).value for f in fields(made)} == {
        n: v for n, (v, _) in MOUNT.items()
    }
    for field in fields(made):
        most = MOUNT[field.name][1]
        assert dict(field.metadata) == {"unit": "arcsec", "low": -most, "high": most}
        assert getattr(made, field.name).unit == "arcsec"


def test_a_supply_is_stiff_and_an_axis_turns_without_end_unless_a_file_says_otherwise() -> None:
    given = model.load("low_preload")
    assert given.supply.resistance.si == 0.0
    assert given.axes.ra.stops is None and given.axes.ra.motor.diode_drop is None and given.mount is None
    assert all(f.default is MISSING for f in fields(Stops))


def test_an_effect_acts_once_per_turn_of_its_stage_and_on_both_motors_unless_it_says_otherwise() -> None:
    effect = EffectModel("gear_mesh", "mesh1")
    assert (effect.harmonic, effect.enabled, dict(effect.parameters)) == (1, True, {})
    assert Function("torque", "time", "linear", 0.0, ((0.0, 1.0),), "a test").motor == 0


@pytest.mark.parametrize(
    ("path", "good", "bad"),
    [
        ("numerics.grid", 2000.0, 2001.0),  # us
        ("supply.voltage", 1.0, 0.99),
        ("axes.ra.gear.backlash", 2065.4, 2065.5),  # deg of the motor: 0.1 rad times the ratio, 360.489
        ("axes.dec.encoders.absolute", 32.0, 33.0),
        ("focus.lvdt_offset", -2000.0, -2001.0),  # mV
    ],
)
def test_a_file_is_held_to_the_bounds_in_its_own_units(path: str, good: float, bad: float) -> None:
    base = model.load("low_preload")
    assert model.get(model.loads(model.dumps(model.with_value(base, path, good))), path).value == good
    with pytest.raises(model.ModelError, match=rf"{path}: .* is outside "):
        model.loads(model.dumps(model.with_value(base, path, bad)))
