"""The effort of the tick that is not logged, from the law: the set point held over a row, or on a ramp."""

from pathlib import Path

import numpy as np
import pytest

from calibration.balances.electrical import electrical_problem
from calibration.balances.frame import build_frame
from calibration.balances.motion import motion_of
from calibration.balances.torque import WIDTH
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import declared_numbers
from calibration.statistics.regression import gls
from plant.loop import Excitation, simulate
from plant.model import load
from tests.calibration.logs import write_log

ROWS = 9000
# arcsec/s per row, up and down again at 2400 arcsec/s2: a held set point jumps by ten counts every other tick
RAMPS = 2400.0 * np.abs((np.arange(2 * ROWS) * 0.005 + 1.25) % 5.0 - 2.5) - 3000.0


@pytest.mark.parametrize("held", [True, False])
def test_the_gain_of_the_law_explains_the_volts(tmp_path: Path, held: bool) -> None:
    model = load("low_preload")
    wanted = RAMPS[::2] if held else RAMPS
    log = simulate(model, "ra", ROWS * 0.01, Excitation(setpoint=wanted, start_steps=3e8), seed=3)
    path = tmp_path / "run1.log"
    write_log(path, log)
    runs = [read_axis_log(path, path.read_text(encoding="utf-8"))]
    frame = build_frame(runs)
    e = electrical_problem(
        frame, motion_of(frame, WIDTH), np.zeros(ROWS, dtype=bool), declared_numbers(runs, None)
    )
    assert e is not None
    p = e.problem
    names = [name for name, _ in p.base_labels]
    at = names.index("gain_of_held_set_point" if held else "gain_between_rows")
    with_it = gls(p.y, p.base, p.train, p.ar_order, p.block)
    without = gls(p.y, np.delete(p.base, at, axis=1), p.train, p.ar_order, p.block)
    left = [np.std(f.residual[p.train]) for f in (with_it, without)]
    # the plant file's own gain; the winding follows within a tick to nine tenths, whole counts dilute it
    assert with_it.beta[at] == pytest.approx(model.controller.kp.si, rel=0.2 if held else 0.4)
    assert left[0] < (0.6 if held else 0.98) * left[1]
    if not held:
        assert "gain_of_held_set_point" not in names
