"""A log of a plant whose power stage switches: its balance of volts has the diode's drop in its base."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.balances.bridge import undo_sampling
from calibration.balances.electrical import electrical_problem
from calibration.balances.frame import build_frame
from calibration.balances.motion import motion_of
from calibration.balances.torque import WIDTH
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.declaredplant import declared_numbers
from calibration.statistics.regression import gls
from calibration.statistics.tails import rms
from plant.loop import Excitation, simulate
from plant.model import dump
from tests.calibration.logs import write_log
from tests.plant.bench import switching

ROWS = 9000
# arcsec/s per row, both ways: neither motor reaches the end of its converter
WANTED = 2000.0 * np.sin(np.arange(ROWS) * 0.01 * 2 * np.pi / 20.0)


def test_the_drop_of_the_diode_is_found_beside_resistance_and_constant(tmp_path: Path) -> None:
    model = switching("low_preload_bridge")
    log = simulate(model, "ra", ROWS * 0.01, Excitation(setpoint=WANTED, start_steps=3e8), seed=3)
    path = tmp_path / "run1.log"
    write_log(path, log)
    run = read_axis_log(path, path.read_text(encoding="utf-8"))
    file = tmp_path / "plant.yaml"
    dump(model, file)
    runs = [replace(run, header=run.header | {"note": "schmidt, plant low_preload_bridge"})]
    frame = build_frame(runs)
    declared = declared_numbers(runs, file)
    assert declared.ripple is not None
    undo_sampling(frame, declared.ripple)
    e = electrical_problem(frame, motion_of(frame, WIDTH), np.zeros(ROWS, dtype=bool), declared)
    assert e is not None
    p = e.problem
    fit = p.named(p.fit())
    assert fit["diode_drop"].value == pytest.approx(0.7, rel=0.01)  # the plant's
    assert fit["resistance"].value == pytest.approx(declared.resistance, rel=0.01)
    assert fit["torque_constant"].value == pytest.approx(declared.torque_constant, rel=0.01)
    # a motor that is dragged is the same circuit: its rows are in, and nothing is left for `diode_braking`
    dragged = p.valid & (e.windings.rate < -1.0)
    assert e.windings.counter is not None and not e.windings.counter.dragged.any()
    assert dragged.sum() > 500 and rms(p.fit().residual[dragged]) < 0.01
    bare = np.delete(p.base, p.place("diode_drop"), axis=1)
    without = gls(p.y, bare, p.train, p.ar_order, p.block)
    missed = abs(without.beta[p.place("torque_constant")] - declared.torque_constant)
    assert abs(fit["torque_constant"].value - declared.torque_constant) < 0.5 * missed
