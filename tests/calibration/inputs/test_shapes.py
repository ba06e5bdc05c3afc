"""Logs that are no table of numbers, and channels that no column holds as they are."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from calibration.balances.balance import problem_of
from calibration.balances.floors import passed
from calibration.balances.view import view_of
from calibration.errors import CalibrationInputError
from calibration.inputs.clock import in_order
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.inputs.run import Run, quantum, rows_per_reading, step_of
from calibration.look.search import scene_of
from calibration.names.gravity_imbalance import NAME as WEIGHT
from calibration.names.lines import line, of_stage

STEP_S = 0.01
ROWS = 300
T = STEP_S * np.arange(ROWS)
T_LONG = STEP_S * np.arange(100_000)
X = np.sin(T)
U = np.cos(3.0 * T)
COLUMNS = """  time: {column: t, unit: s}
  position: {column: x, unit: rad}
  effort: {column: u, unit: V}
"""
TAIL = "response: {channel: effort, unit: V}\nestimate: [viscous, offset]\n"


def read(folder: Path, text: str, columns: str = COLUMNS, more: str = "", name: str = "a.csv") -> Run:
    (folder / "rig.yaml").write_text(f"rig: r\ncolumns:\n{columns}{TAIL}{more}", encoding="utf-8")
    (folder / name).write_text(text, encoding="utf-8")
    return read_drive([folder / name], load_rig(folder / "rig.yaml")).records[0]


def rows(*columns: object, head: str = "t,x,u") -> str:
    return "\n".join([head, *(",".join(map(str, row)) for row in zip(*columns, strict=True))]) + "\n"  # type: ignore[call-overload]


@pytest.mark.parametrize(
    ("form", "stamp"),
    [
        ("iso", lambda s: f"2024-10-27T00:59:{s:06.3f}Z"),
        ("iso", lambda s: f"2024-10-27 02:59:{s:06.3f}+02:00"),
        ("iso", lambda s: f'"2024-10-27T00:59:{s:06.3f}"'),
        ("'%d.%m.%Y %H:%M:%S.%f'", lambda s: f"27.10.2024 00:59:{s:06.3f}"),
    ],
)
def test_stamps_in_words_are_seconds(tmp_path: Path, form: str, stamp: object) -> None:
    columns = COLUMNS.replace("unit: s}", f"unit: s, format: {form}}}")
    text = rows([stamp(s) for s in T], X, U)  # type: ignore[operator]
    run = read(tmp_path, text, columns, "wall_time: {from: time}\n")
    assert run.columns["t"] == pytest.approx(T, abs=1e-6)  # a double since 1970 holds a quarter of a us
    assert run.raw["t"][0] == 1729990740.0  # date -u -d '2024-10-27 00:59' +%s
    assert run.columns["position"].tolist() == X.tolist()


def test_a_clock_that_starts_again_begins_a_run(tmp_path: Path) -> None:
    """Three of 100 rows; a clock that falls back to its middle is no run's first stamp."""
    t = np.tile(T[:100], 3)
    (tmp_path / "rig.yaml").write_text(f"rig: r\ncolumns:\n{COLUMNS}{TAIL}")
    (tmp_path / "a.csv").write_text(rows(t, X, U))
    runs = read_drive([tmp_path / "a.csv"], load_rig(tmp_path / "rig.yaml")).records
    assert [(r.name, r.rows) for r in runs] == [(f"a{{{k}}}", 100) for k in (1, 2, 3)]
    assert runs[2].columns["position"].tolist() == X[200:].tolist()
    with pytest.raises(CalibrationInputError, match=r"time goes backwards from 0\.99 to 0\.5"):
        read(tmp_path, rows(np.where(np.arange(ROWS) < 100, t, t + 0.5), X, U))


def test_a_few_stamps_that_leap_cost_their_rows_alone(tmp_path: Path) -> None:
    """The first is of before a reset, one leaps ahead, one back; an hundredth of the rows may."""
    t, stray = T.copy(), [0, 120, 201]
    t[stray] = [1e3, 50.0, -3.0]
    run = read(tmp_path, rows(t, X, U))
    assert run.columns["position"].tolist() == np.delete(X, stray).tolist()
    assert run.columns["t"] == pytest.approx(np.delete(T, stray) - T[1])
    assert [(r.kind, r.rows) for r in run.repairs if r.channel == "time"] == [("leap", 3)]
    way = COLUMNS.replace("unit: rad}", "unit: rad/s, integrated: true}")
    moved = read(tmp_path, rows(t, np.ones(ROWS), U), way).columns["position"]
    assert np.ptp(moved) == pytest.approx(T[-1] - T[1])  # no stray stamp is a time in which it moved on
    t[10] = 60.0
    with pytest.raises(CalibrationInputError, match="time goes backwards from 1000 to"):
        read(tmp_path, rows(t, X, U))


def test_a_clock_in_rows_of_another_order_is_seen_at_once() -> None:
    """Ten interleaved stretches of a long table, and what one in a hundred allows."""
    t = np.concatenate([T_LONG + k * 1e-5 for k in range(10)])
    assert len(in_order(t)) == len(t)
    t = T_LONG.copy()
    t[50::100] -= 3.0
    assert len(in_order(t)) == len(t) - len(t) // 100


def test_a_word_that_is_no_stamp_names_its_line(tmp_path: Path) -> None:
    columns = COLUMNS.replace("unit: s}", "unit: s, format: iso}")
    with pytest.raises(CalibrationInputError, match=r"a.csv:2: column 't': 'noon' is no stamp of format"):
        read(tmp_path, rows(["noon", "2024-01-01"], [0, 1], [0, 1]), columns)
    with pytest.raises(CalibrationInputError, match="is not a number: a stamp"):
        read(tmp_path, rows(["2024-01-01T00:00:00Z"], [0], [0]))
    columns = COLUMNS.replace("unit: rad", "unit: rad, format: iso")
    with pytest.raises(CalibrationInputError, match=r"position\.format: is for time"):
        read(tmp_path, "", columns)


OBJECTS = [{"t": t, "axis": {"x": x}, "u": [0, u], "on": True} for t, x, u in zip(T, X, U, strict=True)]


@pytest.mark.parametrize(
    "text",
    [
        "\n".join(json.dumps(o) for o in OBJECTS) + '\n{"t": 3.0, "ax',  # a run that was cut off
        json.dumps(OBJECTS, indent=1),
        json.dumps({"t": T.tolist(), "axis.x": X.tolist(), "u.1": U.tolist()}),
    ],
    ids=["lines", "list", "lists"],
)
def test_json_is_a_table_with_a_column_per_key(tmp_path: Path, text: str) -> None:
    columns = COLUMNS.replace("column: x", "column: axis.x").replace("column: u", "column: u.1")
    run = read(tmp_path, text, columns, name="a.jsonl")
    assert run.columns["position"].tolist() == X.tolist()
    assert run.columns["effort"].tolist() == U.tolist()


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ('{"t": 0}\n{"t": \n{"t": 2}\n', r"a.json:2: is not JSON"),
        ('{"t": [0, 1], "x": [0]}', "lists have different lengths"),
        ("[]", "no data rows"),
        ("[1, 2]", "no such column"),
    ],
)
def test_json_that_is_no_table_is_one_clear_line(tmp_path: Path, text: str, says: str) -> None:
    with pytest.raises(CalibrationInputError, match=says):
        read(tmp_path, text, name="a.json")


LONG = "long: {name: signal, value: value}\n"


@pytest.mark.parametrize("as_json", [False, True])
def test_a_long_table_has_a_clock_per_signal(tmp_path: Path, as_json: bool) -> None:
    """The position's stamps are kept; the effort, logged 4 ms later at half the rate, is a straight line
    between its own."""
    late = T[::2] + 0.004
    found = [(t, "x", x) for t, x in zip(T, X, strict=True)]
    found += [(t, "u", 2.0 * t) for t in late if not 1.0 < t < 1.2]
    found += [(t, "other", 1.0) for t in T[::50]]
    found.sort()
    keys = ("t", "signal", "value")
    text = "\n".join(
        [json.dumps(dict(zip(keys, row, strict=True))) for row in found]
        if as_json
        else [",".join(keys), *(f"{float(t)!r},{name},{float(x)!r}" for t, name, x in found)]
    )
    run = read(tmp_path, text, COLUMNS, LONG)
    assert run.columns["position"].tolist() == X.tolist()
    inside = (late[0] <= T) & (late[-1] >= T) & ~((T > 0.984) & (T < 1.204))
    assert run.columns["effort"][inside] == pytest.approx(2.0 * T[inside])
    assert np.isnan(run.columns["effort"][[0, 110]]).all()  # before its first row, and in its gap


def test_a_sensor_has_its_own_step_on_the_stamps_of_another(tmp_path: Path) -> None:
    """Counts of 0.01 between which the effort's stamps lie, and as they were logged."""
    counts = np.round(np.sin(T) / 0.01) * 0.01
    found = [(t, "x", x) for t, x in zip(T, counts, strict=True)] + [(t + 0.003, "u", 2.0 * t) for t in T]
    text = "t,signal,value\n" + "\n".join(f"{t:.6f},{name},{x:.9g}" for t, name, x in sorted(found))
    run = read(tmp_path, text, COLUMNS, LONG)
    assert quantum(run.columns["position"]) != pytest.approx(0.01, rel=1e-6)
    assert step_of([run], "position") == pytest.approx(0.01, rel=1e-6)


def test_noise_of_a_column_that_is_read_seldom_is_that_of_its_readings(tmp_path: Path) -> None:
    """A tenth of the rate, straight lines between: from row to row they hardly move."""
    rng, t = np.random.default_rng(5), STEP_S * np.arange(20_000)
    found = [(at, "x", np.sin(at)) for at in t] + [(at, "u", 0.1 * rng.standard_normal()) for at in t[::10]]
    text = "t,signal,value\n" + "\n".join(f"{at:.6f},{name},{x:.9g}" for at, name, x in sorted(found))
    run = read(tmp_path, text, COLUMNS, LONG)
    assert rows_per_reading([run], "effort") == pytest.approx(10.0)
    rig = load_rig(tmp_path / "rig.yaml")
    view = view_of([run], rig, rig.responses[0])
    assert view.seldom == {"effort": 10}
    assert passed(view, view.columns["effort"]) == pytest.approx(0.1, rel=0.1)  # nothing is filtered


def test_a_signal_that_a_long_table_has_not_is_told(tmp_path: Path) -> None:
    with pytest.raises(CalibrationInputError, match=r"column 'u': has 0 rows; the table has y"):
        read(tmp_path, "t,signal,value\n0,y,1\n1,y,2\n", COLUMNS, LONG)


def test_sign_magnitude_words_are_signed(tmp_path: Path) -> None:
    size = np.round(200 * U)
    words = np.where(size < 0, 1024 - size, size).astype(int)
    columns = COLUMNS.replace("unit: V", "unit: V, scale: 0.5, sign_bit: 10")
    run = read(tmp_path, rows(T, X, words), columns)
    assert run.columns["effort"] == pytest.approx(0.5 * size)
    with pytest.raises(CalibrationInputError, match="is signed already"):
        read(tmp_path, rows(T, X, size), columns)


def test_a_gain_per_file_and_a_load_per_file(tmp_path: Path) -> None:
    """The effort of a law with a gain per file, and gravity in proportion to what is carried."""
    columns = COLUMNS.replace("unit: V", "unit: V, files: {low*: 100, high: 250}", 1)
    columns += "  load: {files: {low*: 0.5, high: 2}, unit: kg}\n"
    (tmp_path / "rig.yaml").write_text(
        f"rig: r\ncolumns:\n{columns}{TAIL.replace('viscous', 'gravity')}", encoding="utf-8"
    )
    rig = load_rig(tmp_path / "rig.yaml")
    for name in ("low1", "high", "other"):
        (tmp_path / f"{name}.csv").write_text(rows(T, X, U), encoding="utf-8")
    drive = read_drive([tmp_path / "low1.csv", tmp_path / "high.csv"], rig)
    assert [r.columns["effort"][7] / U[7] for r in drive.records] == pytest.approx([100, 250])
    view = view_of(drive.records, rig, rig.responses[0])
    p = problem_of(view, drive.records, [])
    gravity = p.base[:, p.place("gravity_cos")]
    assert gravity == pytest.approx(np.where(p.session == 0, 0.5, 2.0) * np.cos(view.x[view.rows]), abs=1e-3)
    with pytest.raises(CalibrationInputError, match="'files' has no number for other"):
        read_drive([tmp_path / "other.csv"], rig)


def test_a_parallel_joints_angle_turns_gravity(tmp_path: Path) -> None:
    columns = COLUMNS + "  joint: {column: q2, unit: rad}\n"
    more = TAIL.replace("viscous", "gravity")
    (tmp_path / "rig.yaml").write_text(f"rig: r\ncolumns:\n{columns}{more}", encoding="utf-8")
    other = 0.7 * np.sin(2.3 * T)
    effort = 5.0 * np.sin(X + other) + 2.0 * np.cos(X) + 0.1
    (tmp_path / "a.csv").write_text(rows(T, X, effort, other, head="t,x,u,q2"), encoding="utf-8")
    rig = load_rig(tmp_path / "rig.yaml")
    records = read_drive([tmp_path / "a.csv"], rig).records
    p = problem_of(view_of(records, rig, rig.responses[0]), records, [])
    found, left = p.plain_fit(p.train)
    sizes = [found[k] for k in ("gravity_sin_joint", "gravity_cos", "gravity_cos_joint", "gravity_sin")]
    assert sizes == pytest.approx([5.0, 2.0, 0.0, 0.0], abs=0.05)  # what the filter takes off the sines
    assert np.std(left[p.train]) < 0.01


def test_two_joints_that_lie_anyhow_turn_gravity(tmp_path: Path) -> None:
    """The weight's torque is the slope of its height, from rotation matrices."""
    columns = COLUMNS + "".join(f"  {name}: {{column: {name}, unit: rad}}\n" for name in ("joint", "joint2"))
    more = TAIL.replace("viscous", "gravity")
    (tmp_path / "rig.yaml").write_text(f"rig: r\ncolumns:\n{columns}{more}", encoding="utf-8")
    others = [0.7 * np.sin(2.3 * T), 0.9 * np.sin(1.1 * T + 1.0)]
    axes = [Rotation.from_euler("xyz", [0.4, -0.3, 0.2]), Rotation.from_euler("xyz", [-0.8, 0.5, 0.1])]

    def height(x: np.ndarray) -> np.ndarray:
        tip = Rotation.from_euler("z", x[:, None]).apply([1.0, 0.3, 0.2])
        for angle, tilt in zip(others, axes, strict=True):
            tip = Rotation.from_euler("z", angle[:, None]).apply(np.add(tilt.apply(tip), [0.2, 0.0, 0.1]))
        return np.asarray(5.0 * tip[:, 1])

    effort = (height(X + 1e-5) - height(X - 1e-5)) / 2e-5 + 0.1
    text = rows(T, X, effort, *others, head="t,x,u,joint,joint2")
    (tmp_path / "a.csv").write_text(text, encoding="utf-8")
    rig = load_rig(tmp_path / "rig.yaml")
    records = read_drive([tmp_path / "a.csv"], rig).records
    p = problem_of(view_of(records, rig, rig.responses[0]), records, [])
    _, left = p.plain_fit(p.valid)
    assert p.base.shape[1] < 2 * 3**2 + 1  # along this motion some of the products are alike
    assert np.std(left[p.valid]) < 0.01 * np.std(p.y[p.valid])  # what the filter takes off the waves
    assert WEIGHT.columns(scene_of(view_of(records, rig, rig.responses[0]), p)) == []  # it is declared


def test_another_force_and_every_files_own_offset_are_terms(tmp_path: Path) -> None:
    """A pressure that pushes, a weight over a pulley that is no column, a load cell's zero."""
    columns = COLUMNS + "  applied: {column: p, unit: bar, files: {a: 1, b: 2}}\n"
    more = TAIL.replace("[viscous, offset]", "[applied, offset_per_file]")
    (tmp_path / "rig.yaml").write_text(f"rig: r\ncolumns:\n{columns}{more}", encoding="utf-8")
    pressure = 5.0 + np.sin(1.7 * T)
    for name, factor, zero in (("a", 1.0, -3.0), ("b", 2.0, 8.0)):
        text = rows(T, X, 60.0 * factor * pressure + zero, pressure, head="t,x,u,p")
        (tmp_path / f"{name}.csv").write_text(text, encoding="utf-8")
    rig = load_rig(tmp_path / "rig.yaml")
    records = read_drive([tmp_path / f"{name}.csv" for name in "ab"], rig).records
    p = problem_of(view_of(records, rig, rig.responses[0]), records, [])
    found, _ = p.plain_fit(p.valid)
    assert found == pytest.approx({"applied": 60.0, "offset_1": -3.0, "offset_2": 8.0}, rel=1e-6)


KNOWN = "constants: {gravity_sin: {value: 3.3, unit: N m, source: a scale}}"


@pytest.mark.parametrize(
    ("more", "says"),
    [
        ("estimate: [viscous, applied]", "belong together"),
        (f"estimate: [gravity, offset]\n{KNOWN}", "constants.gravity_sin: is estimated too"),
        ("estimate: [offset, offset_per_file]", "offset_per_file stands in the place of offset"),
    ],
)
def test_terms_that_need_or_exclude_another_are_told(tmp_path: Path, more: str, says: str) -> None:
    text = f"rig: r\ncolumns:\n{COLUMNS}{TAIL.splitlines()[0]}\n{more}\n"
    (tmp_path / "rig.yaml").write_text(text, encoding="utf-8")
    with pytest.raises(CalibrationInputError, match=says):
        load_rig(tmp_path / "rig.yaml")


def test_lines_above_the_header_row_are_passed_over(tmp_path: Path) -> None:
    """As exports of oscilloscopes and PLCs begin; and a header row that is wrong is told as before."""
    above = "Name;Axis 1\nOperator;N. N.;night shift;x;y\nStart 12:00\n\n"
    table = rows(T, X, U).replace(",", ";")
    assert read(tmp_path, above + table).columns["position"].tolist() == X.tolist()
    with pytest.raises(CalibrationInputError, match=r"a.csv:2: 3 fields, 2 names"):
        read(tmp_path, "t,x\n" + "\n".join(table.replace(";", ",").splitlines()[1:]) + "\n")


def test_a_monitors_log_has_names_day_and_clock_in_columns_of_their_own(tmp_path: Path) -> None:
    """A long table without a header row, its columns parted by any number of blanks."""
    clock = [f"2020-12-08  00:00:{s:09.6f}" for s in T]
    text = "\n".join(
        f"axis:x   {c} {float(x)!r}\naxis:u {c}   {float(u)!r}" for c, x, u in zip(clock, X, U, strict=True)
    )
    columns = """  time: {column: day, clock: clock, unit: s, format: iso}
  position: {column: "axis:x", unit: rad}
  effort: {column: "axis:u", unit: V}
"""
    more = "delimiter: space\nnames: [name, day, clock, value]\nlong: {name: name, value: value}\n"
    run = read(tmp_path, text + "\n", columns, more)
    assert run.columns["t"] == pytest.approx(T, abs=1e-6)
    assert run.columns["position"].tolist() == X.tolist()
    assert run.columns["effort"].tolist() == U.tolist()


def test_a_speed_alone_has_a_position_and_a_torque_alone_one_of_a_known_speed(tmp_path: Path) -> None:
    columns = COLUMNS.replace("column: x, unit: rad", "column: x, unit: turn, scale: 0.5, integrated: true")
    run = read(tmp_path, rows(T, np.cos(T), U), columns)
    assert run.columns["position"] == pytest.approx(0.5 * np.sin(T), abs=1e-5)  # trapezoids: step^2 / 12
    columns = COLUMNS.replace("column: x, unit: rad", "steps: [[0, 3.0]], unit: turn, integrated: true")
    run = read(tmp_path, rows(T, U, head="t,u"), columns)
    assert run.columns["position"] == pytest.approx(3.0 * T)


def test_a_step_that_no_column_holds_is_an_input(tmp_path: Path) -> None:
    columns = COLUMNS + "  reference: {steps: [[0.5, 2.0], [1.0, -1.0]], unit: rad}\n"
    run = read(tmp_path, rows(T, X, U), columns)
    assert run.columns["reference"][[0, 49, 50, 99, 100, -1]].tolist() == [0.0, 0.0, 2.0, 2.0, -1.0, -1.0]
    with pytest.raises(CalibrationInputError, match="must be in the order of their times"):
        read(tmp_path, rows(T, X, U), columns.replace("0.5", "1.5"))


def test_only_the_harmonics_of_a_list_are_looked_for(tmp_path: Path) -> None:
    stages = "stages:\n- {name: a, period: 1, harmonics: [2, 24, 60]}\n- {name: b, period: 2, harmonics: 3}\n"
    turning = np.arange(4000) * STEP_S
    text = rows(turning, 0.5 * turning, np.random.default_rng(1).standard_normal(4000))
    run = read(tmp_path, text, more=stages)
    rig = load_rig(tmp_path / "rig.yaml")
    view = view_of([run], rig, rig.responses[0])
    scene = scene_of(view, problem_of(view, [run], []))
    a, b = (
        {c.harmonic for c in of_stage(scene, stage, line(scene, "gear_mesh", 0.0))} for stage in rig.stages
    )
    assert (a, b) == ({2, 24, 60}, {1, 2, 3})


@pytest.mark.parametrize(
    ("columns", "says"),
    [
        (
            COLUMNS.replace("column: x, ", ""),
            "position: 'column' is missing; without one give files",
        ),
        (COLUMNS + "  load: {column: m, unit: kg}\n", "acts through gravity; add it to estimate"),
    ],
)
def test_what_a_column_lacks_is_one_line(tmp_path: Path, columns: str, says: str) -> None:
    with pytest.raises(CalibrationInputError, match=says):
        read(tmp_path, rows(T, X, U), columns)
