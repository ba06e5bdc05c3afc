"""What columns alone say: one that measures nothing is refused, a line that the filter takes away is told, a
ratio of two sensors is no gap and no delay."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calibration.balances.agreement import velocity_against_position
from calibration.balances.balance import problem_of
from calibration.balances.view import view_of
from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.look.volts import FEW_VOLTS
from tests.calibration.logs import tiny_log
from tests.calibration.test_bad_input import column
from tests.calibration.test_drives import FORCE, SENSORS, answer, found, motion


@pytest.mark.parametrize(("name", "place"), [("velocity", 4), ("tach_a", 7), ("tach_b", 8)])
def test_a_rate_that_never_changes_while_the_axis_speeds_up_is_refused(
    tmp_path: Path, name: str, place: int
) -> None:
    noise = iter(np.random.default_rng(0).integers(-5, 5, 100_000).tolist())
    quicker = iter(np.cumsum(np.linspace(0, 4e4, 3000)).astype(int))
    text = column(column(tiny_log(3000), 3, lambda _: str(next(quicker))), 4, lambda v: v)
    steady = {4: "7", 7: "3", 8: "3"}
    for at, value in steady.items():  # the other rates say something
        text = column(text, at, lambda _, v=value, here=at: v if here == place else str(next(noise)))
    (tmp_path / "stuck.log").write_text(text)
    with pytest.raises(CalibrationInputError, match=rf":12: column '{name}': holds {steady[place]} in every"):
        calibrate([tmp_path / "stuck.log"], out=tmp_path / "out")


def with_aux(text: str, values: list[int]) -> str:
    """A log with an auxiliary encoder's column."""
    count = iter(values)
    lines = text.splitlines()
    at = next(k for k, line in enumerate(lines) if not line.startswith("#"))
    return (
        "\n".join([*lines[:at], lines[at] + ",aux", *(f"{line},{next(count)}" for line in lines[at + 1 :])])
        + "\n"
    )


def test_an_auxiliary_encoder_of_zeros_is_no_board_and_another_constant_is_stuck(tmp_path: Path) -> None:
    """Networks without that board log 0 (docs/example is such a log)."""
    (tmp_path / "none.log").write_text(with_aux(tiny_log(3000), [0] * 3000))
    assert "aux" not in read_axis_log(tmp_path / "none.log").columns
    (tmp_path / "stuck.log").write_text(with_aux(tiny_log(3000), [5] * 3000))
    with pytest.raises(CalibrationInputError, match="column 'aux': holds 5 in every row"):
        read_axis_log(tmp_path / "stuck.log")


def test_a_coarse_rate_of_a_steady_axis_is_not_refused(tmp_path: Path) -> None:
    (tmp_path / "steady.log").write_text(tiny_log(3000))  # 60 counts a row: the velocity stays at 7
    assert calibrate([tmp_path / "steady.log"], out=tmp_path / "out", plots=False) == 0


@pytest.mark.parametrize("channel", ["effort", "velocity"])
def test_a_drives_column_that_never_changes_is_refused(tmp_path: Path, channel: str) -> None:
    t, x, u = motion(5.0)
    (tmp_path / "rig.yaml").write_text(
        FORCE.replace("\nresponse", "\n  velocity: {column: v, unit: m/s}\nresponse")
    )
    rows = {"effort": np.full(len(t), 3.0), "velocity": np.gradient(x, t)}
    if channel == "velocity":
        rows = {"effort": u, "velocity": np.zeros(len(t))}
    table = np.column_stack([t, x, rows["effort"], rows["velocity"]])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,x,u,v", comments="")
    with pytest.raises(CalibrationInputError, match=f"column '{channel[0] if channel != 'effort' else 'u'}'"):
        calibrate([tmp_path / "a.csv"], tmp_path / "rig.yaml", out=tmp_path / "out", plots=False)


def two_sensors(scale: np.ndarray, t: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time, motor and a second sensor that should show 0.02 of it and shows `scale` of that."""
    motor = 2.0 * np.sin(2 * np.pi * 0.13 * t) + 0.7 * np.sin(2 * np.pi * 0.31 * t)
    joint = 0.02 * scale * motor + 5e-5 * np.random.default_rng(3).standard_normal(len(t))
    return t, motor, joint


@pytest.mark.parametrize("declared", [True, False])
@pytest.mark.parametrize("shape", ["line", "saturates"])
def test_a_ratio_that_grows_slowly_is_a_scale_over_time(tmp_path: Path, declared: bool, shape: str) -> None:
    t = np.arange(0, 120, 0.01)
    grown = t / t[-1] if shape == "line" else 1 - np.exp(-t / 40)
    rig = SENSORS if declared else SENSORS.replace(", ratio: 0.02", "")
    data = answer(tmp_path, rig, two_sensors(1 + 0.02 * grown, t))
    assert [(e["name"], e["domain"]) for e in data["effects"]] == [("unknown", "time")]
    assert data["error"]["position"]["after"] < 0.4 * data["error"]["position"]["before"]


def test_a_ratio_that_is_not_the_declared_one_has_its_name_and_size(tmp_path: Path) -> None:
    t = np.arange(0, 60, 0.01)
    data = answer(tmp_path, SENSORS, two_sensors(np.full(len(t), 1.01), t))
    assert found(data) == ["roller_ratio"]
    assert data["effects"][0]["parameters"]["error"]["value"] == pytest.approx(0.0002, rel=0.02)


def test_mains_on_the_efforts_column_are_told_with_their_frequency(tmp_path: Path) -> None:
    t, x, u = motion()
    data = answer(tmp_path, FORCE, (t, x, u + 0.1 * np.sin(2 * np.pi * 50.0 * t + 1.0)))
    (effect,) = data["effects"]
    assert (effect["name"], effect["domain"]) == ("unknown", "time")
    assert effect["frequency_Hz"] == pytest.approx(50.0, abs=0.02)
    assert effect["parameters"]["amplitude"]["value"] == pytest.approx(0.1, rel=0.05)


def test_teeth_that_pass_quicker_than_the_filter_are_no_mains(tmp_path: Path) -> None:
    t, x, u = motion()
    data = answer(tmp_path, FORCE, (t, x, u + 0.3 * np.sin(2 * np.pi * x / 0.004)))
    assert not any(e["frequency_Hz"] for e in data["effects"])


@pytest.mark.slow
def test_a_real_step_of_a_signed_effort_is_no_wrap(tmp_path: Path) -> None:
    """A drive that is switched off at -312 falls to 0: that is no counter of 360."""
    t, x, u = motion()
    off = 0.6 * t[-1]
    counts = np.where(t < off, np.round(-312 * t / off + 0.1 * u), 0.0)
    rig = FORCE.replace("unit: N}\nresponse", "unit: N, scale: 0.1}\nresponse")
    assert "log_wrap" not in found(answer(tmp_path, rig, (t, x, np.minimum(counts, 0))))


def test_rows_that_are_missing_here_and_there_are_told_and_change_nothing(tmp_path: Path) -> None:
    t, x, u = motion()
    keep = np.arange(len(t)) % 300 != 150
    data = answer(tmp_path, FORCE, (t[keep], x[keep], u[keep]))
    assert found(data) == ["sample_loss"]
    assert data["effects"][0]["parameters"]["count"]["value"] == np.sum(~keep)


def test_frames_that_repeat_are_seen_beside_a_reference_that_goes_on(tmp_path: Path) -> None:
    t, x, u = motion()
    at = np.arange(100, len(t) - 100, 97)
    goal = x.copy()
    x, u = x.copy(), u.copy()
    quick = at[np.abs(np.gradient(goal))[at] > np.median(np.abs(np.gradient(goal)))]
    x[at], u[at] = x[at - 1], u[at - 1]
    rig = FORCE.replace("\nresponse", "\n  reference: {column: goal, unit: m}\nresponse")
    (tmp_path / "rig.yaml").write_text(rig)
    table = np.column_stack([t, x, u, goal])
    np.savetxt(tmp_path / "a.csv", table, delimiter=",", header="t,x,u,goal", comments="", fmt="%.9g")
    (record,) = read_drive([tmp_path / "a.csv"], load_rig(tmp_path / "rig.yaml")).runs
    assert [r.kind for r in record.repairs] == ["repeat"]
    assert len(quick) * 0.9 <= record.repairs[0].rows <= len(at)


def test_a_rate_of_noise_alone_has_no_scale(tmp_path: Path) -> None:
    """A stalled motor: the position trembles by its noise, and the tachometer by its own."""
    rng = np.random.default_rng(6)
    t = np.arange(0, 30.0, 0.005)
    place, speed, force = rng.standard_normal((3, len(t)))
    still = 0.01 * np.sin(2 * np.pi * 0.1 * t)
    columns = FORCE.replace("  effort:", "  velocity: {column: v, unit: m/s}\n  effort:")
    (tmp_path / "rig.yaml").write_text(columns)
    rows = np.column_stack([t, still + 1e-3 * place, np.sin(2 * np.pi * 0.3 * t) + force, 1e-3 * speed])
    np.savetxt(tmp_path / "a.csv", rows, delimiter=",", header="t,x,u,v", comments="", fmt="%.9g")
    rig = load_rig(tmp_path / "rig.yaml")
    records = read_drive([tmp_path / "a.csv"], rig).records
    view = view_of(records, replace(rig, smooth_s=0.02), rig.responses[0])
    found = velocity_against_position(view, problem_of(view, records, []).held)
    assert found is not None and found.scaled == ""


@pytest.mark.slow
def test_volts_that_a_wide_filter_leaves_too_few_rows_of_are_told(tmp_path: Path) -> None:
    t, x, u = motion(101.0)
    rig = FORCE.replace("effort", "current").replace("unit: N}\nresponse", "unit: A}\nresponse")
    rig = rig.replace("response:", "  voltage: {column: e, unit: V}\nresponse:") + "smooth_s: 2\n"
    data = answer(tmp_path, rig, (t[::4], x[::4], u[::4], 2 * u[::4]), header="t,x,u,e")
    assert FEW_VOLTS in data["reasons"] and "electrical" not in data["error"]


@pytest.mark.slow
def test_a_filter_that_takes_most_away_is_a_remark(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    t, x, u = motion()
    loud = u + 8.0 * np.sin(2 * np.pi * 40.0 * t) + 8.0 * np.sin(2 * np.pi * 61.0 * t)
    answer(tmp_path, FORCE + "smooth_s: 0.3\n", (t, x, loud))
    assert "! the filter of 0.3 s" in capsys.readouterr().out.replace("\n", " ")
