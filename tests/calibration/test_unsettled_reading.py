"""Table 1's stiffness can be read as one train's or as both trains': a log's header says which."""

from pathlib import Path

import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import declared_numbers
from tests.calibration.test_readers import tiny_log, write

TRAIN = 3.08e6  # N m/rad, paper Table 1
TABLE_1 = (1.0, 0.5)  # it may mean one train, or both side by side


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
