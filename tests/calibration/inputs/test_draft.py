"""`schmidt rig --new`: a draft loads, finds the channels that a log shows, and calibrates at once."""

import io
from datetime import datetime, timedelta
from pathlib import Path

import numpy as np
import pytest
from click.testing import CliRunner
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from calibration.command import calibrate
from calibration.errors import CalibrationInputError
from calibration.inputs.declaration import Rig
from calibration.inputs.draft import draft
from calibration.inputs.logs import read_drive
from calibration.inputs.loose import said
from calibration.inputs.rigfile import load_rig
from scenarios.cli import cli

STEP_S = 0.01
T = STEP_S * np.arange(3000)
X = 3.0 * np.sin(0.9 * T) + 0.5 * np.sin(2.3 * T)
V = 2.7 * np.cos(0.9 * T) + 1.15 * np.cos(2.3 * T)
A = -2.43 * np.sin(0.9 * T) - 2.645 * np.sin(2.3 * T)
U = 0.4 * A + 1.5 * np.tanh(20.0 * V) + 0.3 * V + 0.05 * np.random.default_rng(5).standard_normal(len(T))
COLUMNS = (T, X, V, U)


def write(path: Path, head: list[str] | None, columns: object = COLUMNS, mark: str = ",") -> Path:
    rows = zip(*columns, strict=True)  # type: ignore[call-overload]
    text = "" if head is None else mark.join(head) + "\n"
    path.write_text(text + "\n".join(mark.join(map(str, row)) for row in rows) + "\n", encoding="utf-8")
    return path


def drafted(log: Path) -> Rig:
    rig = log.with_suffix(".yaml")
    rig.write_text(draft(log), encoding="utf-8")
    found = load_rig(rig)
    read_drive([log], found)
    return found


def places(rig: Rig) -> dict[str, str | int]:
    return {channel: c.column for channel, c in rig.columns.items()}


@pytest.mark.parametrize(
    "head",
    [
        ["time [s]", "angle [rad]", "speed [rad/s]", "torque [N m]"],
        ["t_s", "motorPos_rad", "motorVel", "measuredTorque_Nm"],
        ["a", "b", "c", "d"],  # by what moves with what alone
    ],
)
def test_names_units_and_motion_say_what_a_column_is(tmp_path: Path, head: list[str]) -> None:
    rig = drafted(write(tmp_path / "a.csv", head))
    found = places(rig)
    assert [found[c] for c in ("time", "position", "velocity")] == head[:3]
    assert found[rig.responses[0].channel] == head[3] and rig.responses[0].is_force
    assert set(rig.estimate) == {"inertia", "viscous", "coulomb", "offset"}
    assert rig.columns["velocity"].scale == 1.0


def test_a_file_without_header_has_names_and_every_guess_is_marked(tmp_path: Path) -> None:
    log = write(tmp_path / "a.csv", None)
    assert places(drafted(log)) == dict(
        zip(("time", "position", "velocity", "effort"), (f"column{k}" for k in range(1, 5)), strict=True)
    )
    lines = [row for row in draft(log).splitlines() if row.startswith("  ") and "time:" not in row]
    assert len(lines) == 3 and all("# guessed: " in row for row in lines)


@pytest.mark.parametrize(
    ("unit", "factor", "scale"), [("ms", 1e3, 1e-3), ("us", 1e6, 1e-6), ("min", 1 / 60, 60.0)]
)
def test_a_clock_is_in_seconds(tmp_path: Path, unit: str, factor: float, scale: float) -> None:
    log = write(tmp_path / "a.csv", [f"time ({unit})", "angle", "v1", "torque"], (T * factor, X, V, U))
    assert drafted(log).columns["time"].scale == pytest.approx(scale)
    assert f"{1 / STEP_S:.5g} Hz" in draft(log).splitlines()[0]


def test_a_rate_in_other_units_has_their_factor_and_a_strange_one_its_own(tmp_path: Path) -> None:
    head = ["t", "angle [deg]", "speed [rpm]", "torque"]
    assert drafted(write(tmp_path / "a.csv", head, (T, X, V / 6.0, U))).columns[
        "velocity"
    ].scale == pytest.approx(6)
    log = write(tmp_path / "b.csv", ["t", "angle", "speed", "torque"], (T, X, 4.3 * V, U))
    assert drafted(log).columns["velocity"].scale == pytest.approx(1 / 4.3, rel=0.02)
    assert "# guessed: its factor, by the position's rate" in draft(log)
    noisy = 4.3 * V + 0.2 * np.std(4.3 * V) * np.random.default_rng(2).standard_normal(len(V))
    log = write(tmp_path / "n.csv", ["t", "angle", "speed", "torque"], (T, X, noisy, U))
    assert drafted(log).columns["velocity"].scale == pytest.approx(
        1 / 4.3, rel=0.02
    )  # noise biases no factor
    log = write(tmp_path / "c.csv", ["t", "angle", "speed", "torque"], (T, X, U**3, U))
    assert "velocity" not in places(drafted(log)) and "does not go with the position's rate" in draft(log)


@pytest.mark.parametrize(("part", "taken"), [(0.009, "b_position [rad]"), (0.011, "a_position [rad]")])
def test_of_two_joints_the_one_that_moves_is_the_position(tmp_path: Path, part: float, taken: str) -> None:
    head = ["t", "a_position [rad]", "b_position [rad]", "torque"]
    log = write(tmp_path / "log.csv", head, (T, part * np.ptp(X) * np.sin(0.3 * T) / 2, X, U))
    assert drafted(log).columns["position"].column == taken


def test_stamps_in_words_and_long_tables_are_drafted(tmp_path: Path) -> None:
    begin = datetime(2024, 5, 1, 23, 59, 50)
    stamps = [(begin + timedelta(seconds=float(t))).isoformat() for t in T]
    rig = drafted(write(tmp_path / "a.csv", ["when", "angle", "v", "torque"], (stamps, X, V, U)))
    assert rig.columns["time"].format == "iso" and rig.wall_time == {"from": "time"}
    names = np.tile(["angle", "torque"], len(T))
    values = np.column_stack([X, U]).ravel()
    log = write(tmp_path / "b.csv", ["when", "signal", "value"], (np.repeat(stamps, 2), names, values))
    rig = drafted(log)
    assert rig.long == {"name": "signal", "value": "value"}
    assert places(rig) == {"time": "when", "position": "angle", "force": "torque"}


def test_a_counter_that_wraps_and_a_sensors_steps_say_the_unit(tmp_path: Path) -> None:
    counts = np.round(300.0 * T) % 2048
    rig = drafted(write(tmp_path / "a.csv", ["t", "encoder", "torque"], (T, counts, U)))
    assert (rig.columns["position"].wrap, rig.turn, rig.stages[0].period) == (2048.0, 2048.0, 2048.0)
    step = 2 * np.pi / 4096
    rig = drafted(write(tmp_path / "b.csv", ["t", "angle", "torque"], (T, step * np.round(X / step), U)))
    assert rig.columns["position"].unit == "rad"


@pytest.mark.parametrize(
    ("head", "columns", "channel"),
    [
        (["t", "rpm"], (T, 60.0 + np.sin(5.0 * T)), "velocity"),
        (["t", "goal", "sensor"], (T, X, np.roll(X, 7)), "position2"),
        (["t", "angle"], (T, X), "acceleration"),
        (["t", "torque"], (T, U), "force"),
        (["pos", "torque"], (X, U), "force"),
        (["t", "torque_cmd", "pos", "torque_meas"], (T, np.sign(U), X, U), "force"),
        (["t", "pos", "torque_cmd"], (T, X, U), "effort"),
        (["Time [s]", "Normal [N]", "Position [mm]", "Friction [N]"], (T, 9 + 0.1 * X, X, U), "force"),
    ],
)
def test_what_a_log_shows_is_explained(
    tmp_path: Path, head: list[str], columns: tuple[object, ...], channel: str
) -> None:
    rig = drafted(write(tmp_path / "a.csv", head, columns))
    assert rig.responses[0].channel == channel
    assert rig.responses[0].divide_by == ("normal" if "Normal [N]" in head else None)


ODD = st.text(
    st.characters(exclude_categories=["Cs", "Cc", "Zl", "Zp"], exclude_characters=",;\t#%\"'{["), max_size=12
)
WORDS = st.sampled_from(
    [
        *("t", "time", "pos", "Position [mm]", "vel", "rpm", "goal", "run", "i", "in", "u", "frame"),
        *("temp (degC)", "torque_in", "y", "on", "null", "~", "a: b", "- x", "&a", "*", "!x", "@", "`"),
        *("|", ">", "?", "1e3", "0x1", "=", "<<"),
    ]
)


ENDLESS = {"inf", "infinity"}


@pytest.mark.slow
@settings(max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(head=st.lists(st.one_of(ODD, WORDS), min_size=4, max_size=4), order=st.permutations(range(4)))
def test_any_header_makes_a_draft_that_loads(tmp_path: Path, head: list[str], order: list[int]) -> None:
    columns = [COLUMNS[k][:400] for k in order]
    assume(not ENDLESS & {word.strip().lower().lstrip("+-") for word in head})
    drafted(write(tmp_path / "a.csv", head, columns))


def test_a_number_without_end_is_drafted_and_refused_with_its_row(tmp_path: Path) -> None:
    log = write(tmp_path / "a.csv", ["", "", "", "INF"])  # no words: a row of numbers
    rig = tmp_path / "rig.yaml"
    rig.write_text(draft(log), encoding="utf-8")
    with pytest.raises(CalibrationInputError, match="is infinite in data row 1"):
        read_drive([log], load_rig(rig))


@pytest.mark.filterwarnings("error")
def test_numbers_beyond_all_measuring_are_none(tmp_path: Path) -> None:
    rows = (f"{k},{k % 7},{k % 5}e300" for k in range(60))
    (tmp_path / "a.csv").write_text("\n".join(["t,q,u", *rows]))
    assert "column: u" not in draft(tmp_path / "a.csv")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("a,b\n1,2\n1,2\n1,2\n", "has no column of numbers that move"),
        ("# format: axis-log 1\n# axis: ra\nt\n0\n", "says itself what it holds"),
        ("", "has no data rows"),
        ("t;x\n0,00;1,5\n0,01;1,6\n", r"a\.csv:2: column 't': '0,00' is not a number: decimal commas"),
    ],
)
def test_what_no_rig_file_can_be_drafted_of_says_so(tmp_path: Path, text: str, says: str) -> None:
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    with pytest.raises(CalibrationInputError, match=says):
        draft(tmp_path / "a.csv")


@pytest.mark.parametrize(
    ("name", "channel", "unit", "scale", "asked"),
    [
        ("Position [mm]", "position", "mm", 1.0, False),
        ("goalPos (deg)", "position", "deg", 1.0, True),
        ("current_mA", "current", "A", 1e-3, False),
        ("rpm", "velocity", "turn/s", 1 / 60, False),
        ("tau_des", "force", "", 1.0, True),
        ("Y_id{*}(1,:)", "", "", 1.0, False),
        ("feedback_deg_s", "velocity", "deg/s", 1.0, False),
        ("acc_m_s2", "acceleration", "m/s2", 1.0, False),
    ],
)
def test_what_a_name_says(name: str, channel: str, unit: str, scale: float, asked: bool) -> None:
    found = said(name)
    assert (found.channel, found.unit, found.asked) == (channel, unit, asked)
    assert found.scale == pytest.approx(scale)


@pytest.mark.slow
def test_a_strangers_first_try(tmp_path: Path) -> None:
    """`calibrate` without a rig points to the draft, and runs on what that prints."""
    log = write(tmp_path / "my.csv", ["time [s]", "angle [rad]", "speed [rad/s]", "torque [N m]"])
    with pytest.raises(CalibrationInputError, match=r"schmidt rig --new my\.csv"):
        calibrate([log], None, [], tmp_path / "out")
    shown = CliRunner().invoke(cli, ["rig", "--new", str(log)])
    assert shown.exit_code == 0
    rig = tmp_path / "draft.yaml"
    rig.write_text(io.StringIO(shown.output).read(), encoding="utf-8")
    assert calibrate([log], rig, [], tmp_path / "out", plots=False) == 0
    assert '"verdict"' in (tmp_path / "out" / "report.json").read_text(encoding="utf-8")
    assert CliRunner().invoke(cli, ["rig", "--new", str(rig), str(log)]).exit_code == 2
