"""What a declaration is by itself: orders, kinds, units, trains, and the numbers of the project's plant."""

from math import pi
from pathlib import Path
from typing import Any

import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Column, Controller, FrictionLaw, Motors, Response, Rig, Stage, made
from calibration.inputs.train import stages_of, train_of
from calibration.inputs.units import is_rate, rad_per_unit, units_per_turn

PATH = Path("rig.yaml")


def stage(kind: str | None, harmonics: int = 3, listed: tuple[int, ...] = ()) -> Stage:
    return Stage("a", 1.0, None, harmonics, kind, listed)


def test_a_stages_harmonics_are_all_or_those_listed() -> None:
    assert stage(None).orders == (1, 2, 3) and stage(None, 1).orders == (1,)
    assert stage(None, 3, (1, 3, 5)).orders == (1, 3)


@pytest.mark.parametrize(
    ("kind", "declared", "of_motor"),
    [
        ("motor", "motor", True),
        ("motor_cogging", "motor_cogging", True),
        ("gear_mesh", "gear_mesh", False),
        ("unknown", None, False),
        (None, None, False),
        ("roller", "roller", False),
    ],
)
def test_a_guessed_stage_has_no_kind(kind: str | None, declared: str | None, of_motor: bool) -> None:
    assert (stage(kind).declared, stage(kind).of_motor) == (declared, of_motor)


@pytest.mark.parametrize(
    ("channel", "unit", "force", "speed"),
    [
        ("effort", "V", True, False),
        ("velocity", "counts", True, True),
        ("effort", "rad/s", True, True),
        ("position2", "rad/s", False, False),
        ("position", "deg", False, False),
    ],
)
def test_a_response_is_a_balance_of_forces_or_a_speed(
    channel: str, unit: str, force: bool, speed: bool
) -> None:
    found = Response(channel, unit)
    assert (found.is_force, found.is_speed, found.gain, found.ratio) == (force, speed, 1.0, None)


def test_a_friction_law_is_plain_unless_said() -> None:
    law = FrictionLaw(bristle_travel=0.02)
    assert (law.stiction_ratio, law.stribeck_speed, law.stribeck_exponent) == (1.0, 1.0, 2.0)
    assert law.numbers == {"stiction": 1.0, "stribeck_speed": 1.0, "sigma_0": 50.0}
    drives = [Rig("r", PATH, {}, (Response(c, ""),), ()) for c in ("position", "effort")]
    assert [r.drifts for r in drives] == [True, False]
    assert Rig("r", PATH, {}, (), (), format="phd2").drifts and drives[0].hold_out == 0.4


def test_a_files_numbers_are_those_of_the_fields_kinds() -> None:
    c = made(
        Column,
        {"unit": "V", "column": "u", "scale": 2, "steps": [[0, 1], [2, 3]], "files": {"a*": 1}, "odd": 1},
    )
    assert (c.scale, c.steps, c.files) == (2.0, ((0.0, 1.0), (2.0, 3.0)), {"a*": 1.0})
    assert (c.offset, c.delay_s, c.integrated, c.wrap) == (0.0, 0.0, False, None)
    assert isinstance(c.scale, float) and isinstance(c.steps[0][0], float)
    given = {"counter_torque": 0.1, "torque_constant_Nm_per_A": 1, "resistance_ohm": 2,
             "train_stiffness_Nm_per_rad": 3, "rotor_inertia_kgm2": [1, 2]}  # fmt: skip
    m = made(Motors, given)
    assert (m.torque_constant, m.resistance, m.train_stiffness, m.rotor_inertia) == (
        1.0,
        2.0,
        3.0,
        (1.0, 2.0),
    )
    assert m.stiffness_readings == (1.0,)
    assert made(Controller, {"law": "pid", "gains": {"p": 2}}, gains={"p": 9.0}).gains == {"p": 9.0}
    nested = made(Rig, {"controller": {"law": "pid", "gains": {"p": 2}}, "names": ["a"]},
                  name="r", path=PATH, columns={}, responses=(), stages=())  # fmt: skip
    assert nested.controller == Controller("pid", {"p": 2.0}) and nested.names == ("a",)


@pytest.mark.parametrize(
    ("unit", "turn"),
    [
        ("rad", 2 * pi), ("radians", 2 * pi), ("mrad", 2000 * pi), ("gon", 400.0), ("deg", 360.0),
        ("Degrees", 360.0), ("°", 360.0), ("arcmin", 21600.0), ("arcsec", 1296000.0), ("rev", 1.0),
        ("motor turns", 1.0),
        ("mm", None), ("", None), (" ", None),
    ],
)  # fmt: skip
def test_a_units_name_says_how_many_are_a_turn(unit: str, turn: float | None) -> None:
    assert units_per_turn(unit) == (turn if turn is None else pytest.approx(turn))
    per = None if turn is None else pytest.approx(2 * pi / turn)
    assert rad_per_unit(unit, per_s=False) == per and rad_per_unit(f"{unit}/ s", per_s=True) == per
    assert rad_per_unit(unit, per_s=True) is None and rad_per_unit(f"{unit}/min", per_s=True) is None


def test_a_rate_is_per_time() -> None:
    rates = ("rpm", "RPM ", "rad/s", "turn/min", "deg per s", "deg per min.", "mm/s.")
    assert [is_rate(u) for u in rates] == [True] * 7
    assert [is_rate(u) for u in ("rad", "rad/s2", "", "rpms", "m/h")] == [False] * 5


def teeth(*items: dict[str, Any]) -> list[Stage]:
    return stages_of(PATH, list(items))


def test_teeth_are_periods_and_a_train_is_cycles_per_turn() -> None:
    wheel = {"name": "wheel", "period": 6.0, "kind": "axis"}
    pinion = {"name": "pinion", "of": "wheel", "teeth": [60, 20], "harmonics": [2, 5], "kind": "gear_mesh"}
    worm = {"name": "worm", "period_s": 480.0, "harmonics": 4}
    slow = {"name": "slow", "of": "worm", "teeth": [10, 20]}
    found = teeth(wheel, pinion, worm, slow)
    assert [(s.period, s.period_s, s.harmonics, s.listed) for s in found] == [
        (6.0, None, 2, ()), (2.0, None, 5, (2, 5)), (None, 480.0, 4, ()), (None, 960.0, 2, ())
    ]  # fmt: skip
    drive = Rig("r", PATH, {"position": Column("deg")}, (), (*found, Stage("m", 0.5, None, 2, "motor")))
    train = train_of(drive)
    assert train.orders == {"wheel": 60.0, "pinion": 180.0, "m": 720.0} and train.ratio == 720.0
    assert (
        train.shafts == ("m",)
        and train.motor == "m"
        and train.one("axis") == "wheel"
        and train.one("x") is None
    )
    assert (
        train_of(Rig("r", PATH, {"position": Column("mm")}, (), tuple(found), turn=12.0)).orders["wheel"]
        == 2.0
    )
    assert train_of(Rig("r", PATH, {"position": Column("mm")}, (), tuple(found))).orders["wheel"] == 1 / 6
    assert train_of(Rig("r", PATH, {}, (), tuple(found))).orders["wheel"] == 1 / 6
    assert train_of(Rig("r", PATH, {}, (), ())).motor == ""


@pytest.mark.parametrize(
    ("items", "says"),
    [
        ([{"name": "a", "period": 1.0}] * 2, "stages: 'a' is given twice"),
        ([{"name": "a", "of": "b", "teeth": [1, 2]}], "stages.a: 'of' must name a stage given before it"),
    ],
)
def test_a_wrong_train_is_named(items: list[dict[str, Any]], says: str) -> None:
    with pytest.raises(CalibrationInputError) as caught:
        teeth(*items)
    assert str(caught.value) == f"rig.yaml: {says}"
