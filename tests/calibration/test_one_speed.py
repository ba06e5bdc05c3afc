"""Logs at one speed, speeds that are explained, responses of few values, rests between runs, late sensors."""

from pathlib import Path

import numpy as np
import pytest

from calibration.balances.balance import problem_of
from calibration.balances.view import view_of
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.look.search import scene_of
from tests.calibration.test_drives import FORCE, answer, found, motion

MOTOR = """rig: motor at one speed
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: turn}
  CHANNEL: {column: u, unit: UNIT}
response: {channel: CHANNEL, unit: UNIT}
estimate: [offset]
stages:
  - {name: motor, period: 1, harmonics: 12, kind: motor_cogging}
"""
TORQUE = MOTOR.replace("CHANNEL", "force").replace("UNIT", "N m")
SPEED = MOTOR.replace("CHANNEL", "velocity").replace("UNIT", "rpm")
LATE = """rig: encoder against its command
columns:
  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  position2: {column: u, unit: rad}
response: {channel: position2, unit: rad}
"""


def steady(wobble: float = 0.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """t s, turns at 1 turn/s with a slow wobble of the speed, and noise."""
    t = np.arange(0, 20, 0.002)
    x = t + wobble * np.sin(2 * np.pi * t / 7.3)
    return t, x, 0.05 * np.random.default_rng(3).standard_normal(len(t))


def test_at_one_speed_a_stage_is_first_and_the_clock_is_in_its_class(tmp_path: Path) -> None:
    t, x, e = steady()
    data = answer(tmp_path, TORQUE, (t, x, e + np.sin(2 * np.pi * 6 * x)))
    first = data["effects"][0]
    assert (first["name"], first["harmonic"]) == ("motor_cogging", 6)
    assert "command_disturbance" in first["equivalent"] and data["verdict"] == "ambiguous"


def test_files_there_and_back_have_one_speed(tmp_path: Path) -> None:
    """Either goes its own way; a line over the place is one on the clock in both."""
    t, x, e = steady()
    (tmp_path / "rig.yaml").write_text(TORQUE)
    for name, place in (("there", x), ("back", 7.0 - x)):
        rows = np.column_stack([t, place, e])
        np.savetxt(tmp_path / f"{name}.csv", rows, delimiter=",", header="t,x,u", comments="")
    rig = load_rig(tmp_path / "rig.yaml")
    records = read_drive([tmp_path / "there.csv", tmp_path / "back.csv"], rig).records
    view = view_of(records, rig, rig.responses[0])
    speed, slip = scene_of(view, problem_of(view, records, [])).one_speed
    assert speed == pytest.approx(1.0, rel=1e-3) and slip < 1e-3


@pytest.mark.slow
def test_at_two_speeds_each_of_the_two_is_alone(tmp_path: Path) -> None:
    t, x, e = steady(0.6)
    place = answer(tmp_path, TORQUE, (t, x, e + np.sin(2 * np.pi * 6 * x)))
    assert (place["effects"][0]["name"], place["effects"][0]["equivalent"]) == ("motor_cogging", [])
    clock = answer(tmp_path, TORQUE, (t, x, e + np.sin(2 * np.pi * 6 * t)))
    assert clock["effects"][0]["name"] == "command_disturbance"


@pytest.mark.slow
def test_a_speed_is_explained_by_lines_and_by_nothing_else(tmp_path: Path) -> None:
    t, x, e = steady(0.1)
    data = answer(tmp_path, SPEED, (t, x, 60.0 + e + 2 * np.sin(2 * np.pi * 6 * x)))
    assert {(f["name"], f["harmonic"]) for f in data["effects"]} == {("motor_cogging", 6)}


def test_an_effort_of_two_values_is_no_balance(tmp_path: Path) -> None:
    t, x, _ = steady(0.6)
    rig = TORQUE.replace("[offset]", "[inertia, viscous, coulomb, offset]")
    data = answer(tmp_path, rig, (t, x, np.where(t > 10, -0.04, -0.03)))
    assert data["verdict"] == "cannot tell" and found(data) == []
    assert "holds 2 values" in data["separating_experiment"]


def test_a_sensor_that_is_late_by_many_rows_is_late_by_that(tmp_path: Path) -> None:
    t = np.arange(0, 60, 0.02)
    x = np.sin(0.9 * t) + 0.4 * np.sin(2.3 * t + 1)
    late = np.sin(0.9 * (t - 0.14)) + 0.4 * np.sin(2.3 * (t - 0.14) + 1)
    noise = 1e-3 * np.random.default_rng(5).standard_normal(len(t))
    data = answer(tmp_path, LATE, (t, x, 0.8 * late + noise))
    (one,) = data["effects"]
    assert one["name"] == "channel_delay"
    assert abs(one["parameters"]["delay"]["value"] - 0.14) < 0.005


@pytest.mark.slow
def test_a_rest_between_two_runs_is_no_lost_row(tmp_path: Path) -> None:
    t = np.concatenate([k * 12.0 + np.arange(0, 6, 0.02) for k in range(10)])
    x = np.sin(0.9 * t) + 0.4 * np.sin(2.3 * t + 1)
    noise = 1e-3 * np.random.default_rng(6).standard_normal(len(t))
    rig = LATE.replace("response:", "runs: {by: column, column: run}\nresponse:")
    run = np.repeat(np.arange(10), 300)
    data = answer(tmp_path, rig, (t, x, 0.8 * x + noise, run), header="t,x,u,run")
    assert found(data) == []


@pytest.mark.slow
def test_a_declared_line_is_none_of_the_clock_though_a_first_guess_lies_beside_its_order(
    tmp_path: Path,
) -> None:
    """A fifth of a turn: orders within five of each other are one line, and 83 was guessed for 84."""
    t = np.arange(0, 8, 0.001)
    x = 0.0262 * t
    noise = 0.3 * np.random.default_rng(3).standard_normal(len(t))
    rig = TORQUE.replace("harmonics: 12", "harmonics: [1, 2, 7, 12, 14, 42, 84]")
    data = answer(tmp_path, rig, (t, np.round(x, 5), noise + np.sin(2 * np.pi * 84 * x + 0.7)))
    first = data["effects"][0]
    assert (first["name"], first["harmonic"]) == ("motor_cogging", 84)


@pytest.mark.slow
def test_a_short_file_beside_a_long_one_hides_no_frequency(tmp_path: Path) -> None:
    """Of 1.17 Hz a file of 1.3 s has a turn and a half."""
    tables = []
    for seconds in (24.0, 1.3, 24.0):
        t, x, u = motion(seconds)
        tables.append((t, np.round(x, 6), u + 0.5 * np.sin(2 * np.pi * 1.17 * t)))
    data = answer(tmp_path, FORCE, *tables)
    assert data["effects"][0]["name"] == "command_disturbance"
    assert data["effects"][0]["frequency_Hz"] == pytest.approx(1.17, rel=0.005)
