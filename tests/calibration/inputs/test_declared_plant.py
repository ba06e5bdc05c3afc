"""What a log is held against: the emulator's own plant, a plant file, or a rig file's numbers."""

from pathlib import Path

import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.declaredplant import Declared, declared_model, declared_numbers, stage_of_wave
from calibration.inputs.rigfile import telescope
from calibration.inputs.run import Run
from plant.model import default_files, load
from tests.calibration.logs import effect

PLANT = load(default_files()["low_preload"])
PART = PLANT.axes.ra


def log(note: str = "", preload: str | None = None, **more: str) -> Run:
    header = {"axis": "ra", "note": note} | ({} if preload is None else {"preload": preload}) | more
    return Run("a", Path("a.log"), "a", {}, header=header)


def test_a_wave_of_known_order_over_the_axis_angle_has_a_place() -> None:
    assert stage_of_wave(effect("gear_mesh", "mesh3")) == "mesh3"
    assert stage_of_wave(effect("friction_asymmetry")) is None
    assert stage_of_wave(effect("motor_cogging")) is None  # over the motor's angle


def test_the_emulators_own_log_has_its_plant_files_numbers() -> None:
    d = declared_numbers([log("Schmidt 1.0, plant low_preload")], None)
    assert d.own and d.stiffness == PART.gear.stiffness.si / 2 and d.readings == (1.0,)
    assert (d.torque_constant, d.resistance) == (PART.motor.torque_constant.si, PART.motor.loop)
    assert d.switch == pytest.approx(PART.motor.switch_resistance.si + PART.motor.sense_resistance.si)
    pwm = PLANT.controller.pwm_frequency.si
    assert d.ripple == pytest.approx(0.5 / (PART.motor.inductance.si * pwm))
    assert d.gear_lag_s == pytest.approx(PART.gear.damping.si / PART.gear.stiffness.si)
    assert d.diode_drop == (PART.motor.diode_drop.si if PART.motor.diode_drop is not None else 0.0)
    assert d.number("coulomb") == PART.friction.coulomb.si and d.number("sigma_0") == d.bristle_stiffness
    law = d.law
    assert (
        law.stiction_ratio == pytest.approx(d.stiction / d.coulomb) and law.stribeck_speed == d.stribeck_rate
    )
    assert law.bristle_travel == pytest.approx(d.coulomb / d.bristle_stiffness)
    assert d.lines == tuple((e.name, stage_of_wave(e), e.harmonic) for e in PART.effects if stage_of_wave(e))


def test_a_plant_file_that_is_given_has_no_boards_of_its_own(tmp_path: Path) -> None:
    path = tmp_path / "plant.yaml"
    path.write_text(default_files()["high_preload"].read_text(encoding="utf-8"), encoding="utf-8")
    d = declared_numbers([log()], path)
    high = load(path).axes.ra
    assert d.coulomb == high.friction.coulomb.si != PART.friction.coulomb.si
    assert (d.own, d.ripple, d.gear_lag_s) == (False, None, 0.0)


def test_the_declared_plant_is_the_one_given_named_or_of_the_preload(tmp_path: Path) -> None:
    low, high = (load(default_files()[f"{name}_preload"]) for name in ("low", "high"))
    told = [
        declared_model(log().header, None),
        declared_model(log(preload="high").header, None),
        declared_model(log("schmidt, plant high_preload").header, None),
        declared_model(log("of a bench, plant high_preload").header, None),
        declared_model(log("schmidt").header, None),
        declared_model(log().header, default_files()["high_preload"]),
    ]
    assert told == [(low, False), (high, False), (high, True), (low, False), (low, True), (high, True)]


def test_other_logs_have_the_rig_files_numbers() -> None:
    rig = telescope("ra")
    assert rig.motors is not None
    usual, other = rig.friction[:2]
    for preload, f in ((usual.state, usual), (other.state, other), ("none", usual)):
        d = declared_numbers([log(preload=preload)], None)
        assert (d.coulomb, d.state, d.own) == (f.coulomb, f.state, False)
        assert (d.stiffness, d.readings) == (rig.motors.train_stiffness, rig.motors.stiffness_readings)
    assert declared_numbers([log()], None).state == "low"
    said = [log(train_stiffness_Nm_per_rad="5e5"), log()]
    d = declared_numbers(said, None, rig)
    assert (d.stiffness, d.readings) == (5e5, (1.0,)) and (d.diode_drop, d.switch, d.lines) == (0.0, 0.0, ())
    said[1] = Run("b", Path("b.log"), "b", {}, header={"train_stiffness_Nm_per_rad": "6e5"})
    with pytest.raises(CalibrationInputError) as caught:
        declared_numbers(said, None, rig)
    assert str(caught.value) == (
        "b.log: 'train_stiffness_Nm_per_rad' is another one in another log: one drive has one"
    )
    assert Declared.__dataclass_fields__["readings"].default == (1.0,)
