"""The closed loop run again: gains of the log, a held-out run near the floor, what is said else."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.balances.frame import Frame, build_frame
from calibration.command import calibrate
from calibration.inputs.axislog import read_axis_log
from calibration.replay.compare import breaking, comparable
from calibration.replay.gains import identify
from calibration.replay.held import replay
from calibration.replay.trace import Loop, ticks
from plant.gears import RATIO
from plant.loop import Excitation, simulate
from plant.model import default_files, load, with_effects, with_value
from tests.calibration.logs import effect, write_log, write_logs

LINE = effect("gear_mesh", "mesh3", amplitude=(12.0, "N m"), phase=(0.7, "rad"))
PER_AMPERE = 0.39 * RATIO


def frame_of(folder: Path, *effects: Any) -> Frame:
    """Four runs of the compiled loop with the effects, read as logs."""
    return build_frame([read_axis_log(p) for p in write_logs(folder, effects)])


@pytest.fixture(scope="module")
def frame(tmp_path_factory: pytest.TempPathFactory) -> Frame:
    return frame_of(tmp_path_factory.mktemp("replay"), LINE)


def test_gains_of_the_controller_come_out_of_the_log(frame: Frame) -> None:
    declared = load(default_files()["low_preload"]).controller
    found = identify(frame, frame.run < 3)
    assert found is not None
    assert found.kp == pytest.approx(declared.kp.si, rel=0.02)
    assert found.ki == pytest.approx(declared.ki.si, rel=0.02)


def test_a_converter_at_its_end_says_nothing_of_the_torque(frame: Frame) -> None:
    ended = replace(frame, columns=frame.columns | {"current_a": frame.columns["current_a"].copy()})
    ended.columns["current_a"][100:150] = frame.scale["adc_end_A"]
    both = [
        Loop(frame=each, axis="ra", per_ampere=PER_AMPERE, gains=None).measured(frame.run >= 0).torque
        for each in (frame, ended)
    ]
    assert np.isfinite(both[0][100:150]).all() and np.isnan(both[1][100:150]).all()
    both[0][100:150] = np.nan
    assert np.array_equal(*both, equal_nan=True)


def test_gains_and_replay_of_a_roller_of_another_size(tmp_path: Path) -> None:
    """The loop counts the roller: what it has too much of the way is none of its integral."""
    roller = effect("roller_ratio", error=(1300.0, "ppm"))
    frame, declared = frame_of(tmp_path, roller), load(default_files()["low_preload"])
    found = identify(frame, frame.run < 3)
    assert found is not None
    assert found.ki == pytest.approx(declared.controller.ki.si, rel=0.02)
    plain = with_effects(declared, "ra", ())
    again = replay(frame, frame.run == 3, plain, with_effects(plain, "ra", [roller]), PER_AMPERE)
    assert again.rows["position"]["after"] < 0.1 * again.rows["position"]["before"]
    assert again.rows["velocity"]["after"] < 1.5 * again.rows["velocity"]["floor"]


def test_the_plant_that_made_the_log_replays_to_the_floor_and_one_without_the_effect_does_not(
    frame: Frame,
) -> None:
    plain = with_effects(load(default_files()["low_preload"]), "ra", ())
    again = replay(frame, frame.run == 3, plain, with_effects(plain, "ra", [LINE]), PER_AMPERE)
    assert set(again.rows) == {"torque", "velocity", "position"}
    for channel in ("torque", "velocity"):
        row = again.rows[channel]
        # the counts within which the encoders woke up are other ones, so the loop's own noise is another draw
        assert row["after"] < 1.5 * row["floor"], (channel, row)
        assert row["before"] > 2.0 * row["after"], (channel, row)
    assert again.rows["position"]["before"] > 5.0 * again.rows["position"]["after"]
    assert not any("WORSE" in reason for reason in again.reasons)


def test_a_corrected_plant_that_is_worse_is_said_to_be_worse(frame: Frame) -> None:
    plain = with_effects(load(default_files()["low_preload"]), "ra", ())
    wrong = effect("gear_mesh", "mesh3", amplitude=(12.0, "N m"), phase=(0.7 - np.pi, "rad"))
    again = replay(frame, frame.run == 3, plain, with_effects(plain, "ra", [wrong]), PER_AMPERE)
    assert again.rows["torque"]["after"] > 1.5 * again.rows["torque"]["before"]
    assert any("WORSE" in reason and "torque" in reason for reason in again.reasons)


@pytest.mark.parametrize("late_rows", [0, 8])
def test_teeth_are_compared_at_the_logs_own_angle_whatever_its_controller_does_in_a_step(
    tmp_path: Path, late_rows: int
) -> None:
    """80 ms late at a step of 4000 arcsec/s: 0.45 of the teeth's period."""
    wanted = np.repeat([1200.0, -2800.0, 1200.0, -2800.0, 600.0], 900)
    given = np.concatenate([np.repeat(wanted[0], late_rows), wanted[: len(wanted) - late_rows]])
    plain = with_effects(load(default_files()["low_preload"]), "ra", ())
    toothed = with_effects(
        plain, "ra", [effect("gear_mesh", "mesh2", amplitude=(12.0, "N m"), phase=(0.7, "rad"))]
    )
    log = simulate(toothed, "ra", 45.0, Excitation(setpoint=given, start_steps=4e8), seed=3)
    write_log(tmp_path / "run.log", replace(log, setpoint=wanted))
    frame = build_frame([read_axis_log(tmp_path / "run.log")])
    again = replay(frame, np.ones(len(frame.t), dtype=bool), plain, toothed, PER_AMPERE)
    row = again.rows["velocity"]
    assert row["after"] < 1.5 * row["floor"] and row["before"] > 5.0 * row["after"]
    (said,) = [r for r in again.reasons if "transients" in r]
    moved = float(re.search(r"([\d.]+) arcsec after", said)[1])  # type: ignore[index]
    by_hand = np.sqrt(np.mean(np.square([0.0, 4000.0, 4000.0, 4000.0, 3400.0]))) * 0.01 * late_rows
    assert moved == pytest.approx(by_hand, abs=30.0)  # the start itself is known to 10 ms, 12 arcsec


def test_runs_that_are_not_held_out_are_left_alone(frame: Frame) -> None:
    model = with_effects(load(default_files()["low_preload"]), "ra", [LINE])
    again = replay(frame, frame.run == 2, model, model, PER_AMPERE)
    assert again.run == "run3" and again.rows["torque"]["before"] == again.rows["torque"]["after"]
    nothing = replay(frame, np.zeros(len(frame.t), dtype=bool), model, model, PER_AMPERE)
    assert nothing.rows == {} and len(nothing.reasons) == 1


def test_rows_near_a_jump_a_gap_or_a_break_away_are_not_compared(frame: Frame) -> None:
    rows = frame.run == 3
    use = comparable(frame, rows)
    wanted = frame.columns["setpoint"][rows]
    for jump in np.flatnonzero(np.diff(wanted)) + 1:
        assert not use[jump - 1 : jump + 100].any() and use[jump + 102]
    t = np.arange(1000) * 0.01
    slow_then_fast = np.where(t < 5.0, 2.0 * t, 10.0 + 500.0 * (t - 5.0))
    near = breaking(slow_then_fast, 0.01, 4e-4)
    assert near[450:550].all() and not near[:390].any() and not near[610:].any()


def test_a_ramp_of_the_set_point_is_filled_in_between_the_rows_and_a_jump_is_not() -> None:
    assert ticks(np.array([0.0, 0.0, 10.0, 20.0, 30.0, 30.0])).tolist() == pytest.approx(
        [0, 0, 0, 5, 10, 15, 20, 25, 30, 30, 30, 30]
    )
    assert ticks(np.array([0.0, 0.0, 600.0, 600.0])).tolist() == [0, 0, 0, 0, 600, 600, 600, 600]


def test_the_clock_of_the_loop_can_start_late() -> None:
    model = with_effects(load(), "ra", [effect("brake_drag", torque=(200.0, "N m"), start=(100.0, "s"))])
    early = simulate(model, "ra", 4.0, Excitation(setpoint=600.0, effort=0.0))
    late = simulate(model, "ra", 4.0, Excitation(setpoint=600.0, effort=0.0, start_s=98.0))
    assert late.t[0] == pytest.approx(98.0)
    assert np.array_equal(early.position[:199], late.position[:199])
    assert np.mean(late.effort[-50:]) > 1.2 * np.mean(early.effort[-50:])


def test_a_late_column_still_starts_from_its_first_reading() -> None:
    model = with_effects(load(), "ra", [effect("channel_delay", column=(1.0, "1"), delay=(0.05, "s"))])
    log = simulate(model, "ra", 0.2, Excitation(setpoint=0.0, start_steps=4e8, start_s=30.0))
    assert abs(log.position[0] - 4e8) < 2


@pytest.mark.long
def test_report_holds_the_closed_loop_and_may_leave_it_out(tmp_path: Path) -> None:
    paths = write_logs(tmp_path, [LINE])
    calibrate(paths, out=tmp_path / "with", plots=True)
    calibrate(paths, out=tmp_path / "without", plots=False, replay=False)
    told, silent = (json.loads((tmp_path / k / "report.json").read_text()) for k in ("with", "without"))
    assert "closed_loop" not in silent and silent["effects"] == told["effects"]
    for channel, row in told["closed_loop"].items():
        assert set(row) == {"unit", "before", "after", "floor"}
        assert row["after"] < 0.5 * row["before"], channel
    page = (tmp_path / "with" / "report.html").read_text()
    assert "replayed closed loop" in page.lower() and "measured, declared and corrected" in page


def test_an_open_loop_run_is_driven_by_its_effort(tmp_path: Path) -> None:
    model = with_effects(load(default_files()["low_preload"]), "ra", ())
    paths = write_logs(tmp_path, [], kinds=("steps",))
    text = paths[0].read_text().replace("# loop: closed", "# loop: open").splitlines()
    at = next(k for k, line in enumerate(text) if line.startswith("t,"))
    rows = [",".join([c[0], "", *c[2:]]) for c in (line.split(",") for line in text[at + 1 :])]
    paths[0].write_text("\n".join(text[: at + 1] + rows) + "\n")
    frame = build_frame([read_axis_log(paths[0])])
    again = replay(frame, np.ones(len(frame.t), dtype=bool), model, model, PER_AMPERE)
    assert any("open loop" in reason for reason in again.reasons)
    assert again.rows["velocity"]["after"] < 0.05 * 1500.0
    weak = with_value(model, "axes.ra.friction.coulomb", 300.0)
    off = replay(frame, np.ones(len(frame.t), dtype=bool), model, weak, PER_AMPERE)
    assert off.rows["velocity"]["after"] > 2.0 * off.rows["velocity"]["before"]
