"""What the boards, bridges and converters of the plant do to a row's volts is declared, and no effect."""

import numpy as np
import pytest

from calibration.inputs.axislog import read_axis_log
from calibration.inputs.rigfile import telescope
from calibration.look.axis_channels import analyse
from calibration.look.looked import Options
from plant.model import default_files, load
from tests.calibration.logs import write_logs


@pytest.fixture(scope="module")
def volts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, float]:
    """The channel's base by name, after nothing was named in it; logs of 140 s without an effect."""
    paths = write_logs(tmp_path_factory.mktemp("own"), [])
    runs = [read_axis_log(p, p.read_text(encoding="utf-8")) for p in paths]
    s = analyse(runs, telescope(runs[0].header["axis"]), Options()).selections["E"]
    assert [c.candidate.name for c in s.chosen] == []
    names = [name for name, _ in s.problem.base_labels]
    return dict(zip(names, s.after.beta.tolist(), strict=True))


@pytest.mark.slow
def test_a_leading_motor_that_is_dragged_has_its_own_constant(volts: dict[str, float]) -> None:
    motor = load(default_files()["low_preload"]).axes.ra.motor
    assert volts["torque_constant"] == pytest.approx(motor.torque_constant.si, rel=0.02)
    assert volts["emf_of_a_dragged_leader"] == pytest.approx(motor.torque_constant.si, rel=0.5)


@pytest.mark.slow
def test_the_counter_register_waits_and_the_converter_rounds_down(volts: dict[str, float]) -> None:
    assert 0.3 < volts["held_counter_register"] < 1.2  # every second effort of the loop is in the log
    counts = volts["conversion_offset"] / volts["resistance"]
    assert counts == pytest.approx(0.5, abs=0.2)
    assert np.isfinite(list(volts.values())).all()
