"""An axis with two motors that is not the Schmidt telescope's, declared by a rig file."""

import json
from pathlib import Path
from typing import Any

import pytest

from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.rigfile import load_rig, telescope
from calibration.inputs.train import train_of
from plant.gears import ORDERS, RATIO
from tests.blind.drives.case import seal
from tests.blind.drives.cells import HOUR_S
from tests.blind.drives.order import Order
from tests.calibration import azimuth
from tests.calibration.azimuth import RIG, VALUES, write

ROTORS = 2 * VALUES["JM"] * azimuth.RATIO**2  # kg m2 at the axis
CALIBRATED = {
    "coulomb": VALUES["TC"],
    "viscous": VALUES["SIG2"],
    "stiction": VALUES["TS"],
    "stribeck_speed": VALUES["VS"],
    "sigma_0": VALUES["SIG0"],
    "stiffness": VALUES["KGEAR"],
    "torque_constant": VALUES["KA"],
    "resistance": VALUES["RA"],
    "inertia": VALUES["J"] + ROTORS,
}


def report(folder: Path, effects: dict[str, float], drive: dict[str, float] | None = None) -> Any:
    """What is told of a night with these effects."""
    calibrate(write(folder, effects, drive=drive), RIG, [], folder / "out", plots=False)
    return json.loads((folder / "out" / "report.json").read_text())


@pytest.mark.slow
def test_its_numbers_are_calibrated_and_nothing_is_found(tmp_path: Path) -> None:
    told = report(tmp_path, {})
    assert (told["verdict"], told["effects"]) == ("nothing", [])
    for name, true in CALIBRATED.items():
        assert told["calibrated"][name]["value"] == pytest.approx(true, rel=0.02), name
    assert set(told["error"]) == {"torque", "electrical", "position", "velocity", "command"}
    for row in told["error"].values():
        assert row["floor"] is None or row["after"] < 1.3 * row["floor"]
    assert not (tmp_path / "out" / "plant.yaml").exists()  # the emulator has no such drive


@pytest.mark.slow
@pytest.mark.parametrize(
    ("effects", "name", "stage", "size", "value"),
    [
        ({"ASYM_C": 0.15}, "friction_asymmetry", None, "coulomb_asymmetry", 0.15),
        ({"GRAV_A": 12.0, "GRAV_PH": 0.7}, "gravity_imbalance", "axis", "amplitude", 12.0),
        ({"L1_T": 6.0, "L1_ORDER": 20.0, "L1_PH": 1.0}, "gear_eccentricity", "pinion", "amplitude", 6.0),
        (
            {"L1_T": 3.0, "L1_K": 1e-6, "L1_ORDER": 360.0, "L1_PH": 1.0},
            "gear_mesh",
            "ring mesh",
            "amplitude",
            3.0,
        ),
        ({"RIP_A": 0.05, "RIP_N": 7.0, "RIP_PH": 0.3}, "torque_ripple", "motor", "ripple", 0.05),
        ({"SAG": 0.3}, "supply_sag", None, "resistance", 0.3),
        ({"DEADBAND": 0.02}, "pwm_deadband", None, "deadband", 0.02),
        ({"ROLLER_EPS": 2e-4}, "roller_ratio", "tape", "error", 200.0),
        (  # early: the mean constant of the log is not the one that fell
            {"MAG_A": 0.1, "MAG_T0": 40.0, "MAG_RAMP": 5.0, "MAG_SIDE": 0.0},
            "magnet_weakening",
            None,
            "loss",
            0.1,
        ),
        ({"BRAKE_T": 10.0, "BRAKE_T0": 120.0}, "brake_drag", None, "torque", 10.0),
        ({"DELAY_POS": 0.006}, "channel_delay", None, "delay", 0.006),
    ],
)
def test_what_the_telescope_has_names_for_is_named_here(
    tmp_path: Path, effects: dict[str, float], name: str, stage: str | None, size: str, value: float
) -> None:
    told = report(tmp_path, effects)
    (found,) = told["effects"]
    assert (found["name"], found["stage"]) == (name, stage)
    assert found["parameters"][size]["value"] == pytest.approx(value, rel=0.03)


@pytest.mark.slow
def test_a_stiffer_friction_than_declared_is_a_change(tmp_path: Path) -> None:
    told = report(tmp_path, {}, {"TC": 62.0, "TS": 95.0})
    assert {e["name"] for e in told["effects"]} == {"coulomb_change"}


def test_the_telescopes_declaration_is_what_is_emulated() -> None:
    for axis in ("ra", "dec"):
        train = train_of(telescope(axis))
        assert list(train.orders) == list(ORDERS)
        assert list(train.orders.values()) == pytest.approx(list(ORDERS.values()), rel=1e-12)
        assert train.ratio == pytest.approx(RATIO, rel=1e-12)
    assert train_of(load_rig(RIG)).ratio == pytest.approx(azimuth.RATIO, rel=1e-12)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("supply_V: 36\n", "", "a column of the supply or supply_V"),
        ("kind: motor", "kind: gear_mesh", "one stage of kind motor"),
        ("kind: roller", "kind: motor_cogging", "beside motors one of axis, motor, roller"),
        ("column: west_mA, unit: A", "column: west_mA, unit: mA", "columns.current_b.unit: 'mA', must be A"),
        ("az_deg, unit: deg", "az_deg, unit: mm", "columns.position.unit: 'mm', must be an angle"),
        ("tape_deg_s, unit: deg/s", "tape_deg_s, unit: deg", "must be an angle per s"),
        ("rotor_inertia_kgm2: [5.0e-5, 1.0e-3]", "rotor_inertia_kgm2: [1.0e-3, 5.0e-5]", "least, most"),
        ("  effort: {", "  voltage: {", "'effort' is missing"),
        ("turn: 360\n", "turn: 360\nestimate: [viscous]\n", "estimate: a drive with motors has its own"),
        (
            "  motor_b: {column: west_rpm, unit: turn/s, scale: 0.016666666666666666}\n",
            "",
            "'motor_b' is missing",
        ),
        (
            "{name: pinion, of: azimuth, teeth: [360, 18]}",
            "{name: pinion, period_s: 3}",
            "give period or teeth",
        ),
        ("format: x", "", ""),
    ],
)
def test_a_mistake_in_the_declaration_gets_one_line(tmp_path: Path, old: str, new: str, says: str) -> None:
    text = RIG.read_text()
    if old == "format: x":
        text, says = "format: phd2\n" + text, "a log of format phd2 says it itself"
    path = tmp_path / "rig.yaml"
    path.write_text(text.replace(old, new, 1))
    with pytest.raises(CalibrationInputError, match=says) as caught:
        load_rig(path)
    assert "\n" not in str(caught.value)


@pytest.mark.slow
def test_what_is_left_over_the_speed_is_unknown_there_and_not_nothing(tmp_path: Path) -> None:
    """A drag that grows with the square of the speed, on steady speeds: cross-validation behind the noise's
    filter does not see it, and 2.6 floors are left."""
    order = Order("drive-outside-outside_quadratic-telescope-5", "outside", "telescope",
                  ("outside_quadratic",), 5.0, seconds=HOUR_S)  # fmt: skip
    seal(order, 1061, tmp_path / "logs", tmp_path / "truth")
    folder = tmp_path / "logs" / order.key
    calibrate(sorted(folder.glob("*.csv")), folder / "rig.yaml", [], tmp_path / "out", plots=False)
    told = json.loads((tmp_path / "out" / "report.json").read_text())
    assert told["verdict"] == "unknown"
    assert [(e["name"], e["domain"]) for e in told["effects"]] == [("unknown", "velocity")]
