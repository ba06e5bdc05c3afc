"""Table 1's stiffness can be read as one train's or as both trains': between the two nothing can be told."""

from dataclasses import replace
from pathlib import Path

import pytest

from calibration.decide.tolerance import unsettled_reading
from calibration.errors import CalibrationInputError
from calibration.finding import Parameter
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import Declared, declared_numbers
from tests.calibration.test_readers import tiny_log, write

TRAIN = 3.08e6  # N m/rad, paper Table 1
TABLE_1 = (1.0, 0.5)  # it may mean one train, or both side by side
PAPER = Declared(
    coulomb=229.0,
    stiction=621.0,
    stribeck_rate=4e-4,
    viscous=6700.0,
    bristle_stiffness=5.9e6,
    stiffness=TRAIN,
    torque_constant=0.39,
    resistance=2.2,
    readings=TABLE_1,
)


@pytest.mark.parametrize(
    ("times", "settled"), [(1.0, True), (0.85, True), (0.5, False), (0.55, False), (2.0, True), (0.3, True)]
)
def test_half_of_the_declared_stiffness_is_neither_declared_nor_changed(times: float, settled: bool) -> None:
    found = Parameter(times * TRAIN, "N m/rad", 0.99 * times * TRAIN, 1.01 * times * TRAIN)
    assert (unsettled_reading(found, PAPER) == "") is settled
    assert unsettled_reading(found, replace(PAPER, readings=(1.0,))) == ""  # a plant file says what it means
    assert unsettled_reading(None, PAPER) == ""


def test_a_header_settles_it(tmp_path: Path) -> None:
    said = tiny_log().replace("# supply_V: 24\n", "# supply_V: 24\n# train_stiffness_Nm_per_rad: 1.54e6\n")
    bare, declared = (
        declared_numbers([read_axis_log(write(tmp_path / name, text))], None)
        for name, text in (("a.log", tiny_log()), ("b.log", said))
    )
    assert (bare.stiffness, bare.readings) == (TRAIN, TABLE_1)
    assert (declared.stiffness, declared.readings) == (1.54e6, (1.0,))
    with pytest.raises(CalibrationInputError, match="'train_stiffness_Nm_per_rad' is 'soft', must be"):
        read_axis_log(write(tmp_path / "c.log", said.replace("1.54e6", "soft")))
    logs = [read_axis_log(write(tmp_path / "d.log", said.replace("1.54e6", "2e6")))]
    with pytest.raises(CalibrationInputError, match="one drive has one"):
        declared_numbers([*logs, read_axis_log(tmp_path / "b.log")], None)
