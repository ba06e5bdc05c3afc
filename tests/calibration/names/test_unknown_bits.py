"""A stuck bit of the position: found, put right row by row; a coarse or a short motion is none."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.axislog import read_axis_log
from calibration.names.unknown_bits import repair_stuck_bit
from plant.loop import Excitation, simulate
from plant.model import default_files, load, with_effects
from plant.units import ARCSEC
from tests.calibration.logs import write_log


@pytest.mark.slow
@pytest.mark.parametrize(("bit", "held"), [(13, 0), (13, 1), (9, 0), (17, 1)])
def test_a_bit_that_never_changes_is_named_and_every_row_put_right(
    tmp_path: Path, bit: int, held: int
) -> None:
    wanted = np.repeat([600.0, -1500.0, 4000.0], 700)
    model = with_effects(load(default_files()["low_preload"]), "ra", ())
    log = simulate(model, "ra", 21.0, Excitation(setpoint=wanted, start_steps=4e8), seed=2)
    words = log.position.astype(np.int64)
    seen = (words | 1 << bit) if held else (words & ~(1 << bit))
    write_log(tmp_path / "sound.log", log)
    write_log(tmp_path / "stuck.log", replace(log, position=seen.astype(float)))
    sound, stuck = (read_axis_log(tmp_path / f"{k}.log") for k in ("sound", "stuck"))
    assert repair_stuck_bit(sound) is None
    found = repair_stuck_bit(stuck)
    assert found is not None and found.parameters["bit"].value == bit and f"always {held}" in found.note
    off = (stuck.columns["position"] - sound.columns["position"]) / ARCSEC
    # within a start or a step of the rate the roller's window of 5 ms is not the row's motion
    assert np.mean(np.abs(off - np.median(off)) > 1e-6) < 0.005


def test_unused_low_bits_and_a_motion_within_the_step_are_sound(tmp_path: Path) -> None:
    wanted = np.repeat([600.0], 700)
    model = with_effects(load(default_files()["low_preload"]), "ra", ())
    log = simulate(model, "ra", 7.0, Excitation(setpoint=wanted, start_steps=4e8), seed=2)
    write_log(tmp_path / "coarse.log", replace(log, position=16.0 * np.floor(log.position / 16.0)))
    run = read_axis_log(tmp_path / "coarse.log")
    assert repair_stuck_bit(run) is None
    assert repair_stuck_bit(replace(run, raw={})) is None  # a table of the same axis has no counts
