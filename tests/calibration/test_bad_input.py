"""Bad input, one clear answer each: what a reader cannot use is named with its place, and too little data
never gets a confident name."""

import json
from pathlib import Path
from time import monotonic
from typing import Any

import numpy as np
import pytest

from calibration.command import calibrate
from calibration.decide.tolerance import INFLATION
from calibration.errors import CalibrationInputError
from calibration.inputs.axislog import read_axis_log
from calibration.inputs.logs import read_drive
from calibration.inputs.rigfile import load_rig
from calibration.inputs.tables import read_table
from calibration.statistics.regression import inflation
from tests.calibration.logs import tiny_log, write_logs
from tests.calibration.test_readers import RIG


def column(text: str, place: int, change: Any) -> str:
    """The log with one column changed in every row."""
    rows = [line.split(",") for line in text.splitlines()]
    for r in rows:
        if r[0][:1].isdigit():
            r[place] = change(r[place])
    return "\n".join(",".join(r) for r in rows) + "\n"


LOG = tiny_log(300)
DEGREES = column(LOG, 3, lambda v: f"{int(v) * 360 / 2**29 + 10:.7f}")
VOLTS = column(LOG, 2, lambda v: f"{int(v) / 3000 * 24:.4f}")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is empty"),
        (b"\n\n", "is empty"),
        (b"\x89PNG\r\n\x1a\n" + bytes(99), ":1: is not UTF-8"),
        (LOG.encode("utf-16"), "is not UTF-8"),
        (LOG.replace("axis-log 1", "axis-log 2").encode(), ":1: 'format' is 'axis-log 2'"),
        (
            LOG.replace("counter_torque: 0.1\n", "counter_torque: 1.01\n").encode(),
            "must be 0 to 1",
        ),
        (LOG.replace(",", ";").encode(), ":11: the columns are parted by semicolons"),
        (column(LOG, 0, lambda v: v.replace(".", ",")).encode(), ":12: 10 fields.*decimal commas"),
        (column(LOG, 0, lambda v: f"{float(v) * 1000:.0f}").encode(), ":12: column 't': rows are 10 apart"),
        (column(LOG, 2, lambda v: "").encode(), ":12: column 'effort': holds no number"),
        (LOG.replace("\n0.05,15,20,", "\n0.05,15,inf,").encode(), ":17: column 'effort': is infinite"),
        (LOG.replace("\n0.05,15,20,", "\n0.05,15,9999,").encode(), ":17: column 'effort': is beyond full"),
        (DEGREES.encode(), ":12: column 'position': holds fractions"),
        (VOLTS.encode(), ":12: column 'effort': never exceeds 0.16"),
        (LOG.replace("\n0.05,15,20,", "\n0.05,15,2_0,").encode(), ":17: column 'effort': '2_0' is not"),
        (LOG.replace("\n2.99,", "\n1e999,").encode(), ":311: column 't': is infinite"),
        (LOG.replace("\n2.98,", "\x852.98,").encode(), ":309: 17 fields"),
        (LOG.replace("\nt,", "\n" * 400 + "t,").encode(), "no column row in the first 400 lines"),
        ((LOG + LOG).encode(), ":312: 1 fields.*one file holds one run"),
    ],
)
def test_a_file_that_is_no_axis_log_says_why_in_one_line(tmp_path: Path, content: bytes, says: str) -> None:
    path = tmp_path / "bad.log"
    path.write_bytes(content)
    with pytest.raises(CalibrationInputError, match=says) as caught:
        read_drive([path], None)
    assert "\n" not in str(caught.value) and str(path) in str(caught.value)


@pytest.mark.parametrize("content", [b"\xef\xbb\xbf" + LOG.encode(), LOG.replace("\n", "\r\n").encode()])
def test_a_byte_order_mark_and_carriage_returns_do_not_matter(tmp_path: Path, content: bytes) -> None:
    path = tmp_path / "a.log"
    path.write_bytes(content)
    (run,) = read_drive([path], None).runs
    assert run.rows == 300


def test_a_folder_a_missing_file_and_a_file_given_twice_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_text(LOG)
    for logs, says in (
        ([tmp_path], "directory"),
        ([tmp_path / "no.log"], "No such"),
        ([path, path], "twice"),
    ):
        with pytest.raises(CalibrationInputError, match=says):
            read_drive(logs, None)


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ("column: t, unit: s", "column: t, unit: ms", "must be s"),
        ("  time: {column: t, unit: s}\n", "", "'time' is missing"),
        ("  position: {column: x, unit: turn, wrap: 10}\n", "", "'position' is missing"),
        ("gain: 2.0", "gain: 0", "erases the response"),
        ("unit: V}", "unit: V, scale: 0}", "erases the column"),
        ("gain: 2.0", "gain: 1.0e+300", "greater than the maximum"),
        ("unit: V}", "unit: V, delay_s: 1.0e+9}", "greater than the maximum of 3600"),
        ("gain: 2.0", "divide_by: supply", "'supply' is not among the columns"),
        ("stages:", "runs: {by: column}\nstages:", "needs runs.column"),
        ("stages:", "estimate: []\nstages:", "estimate"),
        ("name: wheel", "name: motor", "'motor' is given twice"),
        ("column: u", "column: force", "no such column; the file has t, x, u"),
        ("period: 1.0", "period: 0", "period: 0"),
        ("stages:", "smooth_s: 90\nstages:", "smooth_s: 90 s is too long"),
    ],
)
def test_every_mistake_in_a_rig_file_gets_one_line(tmp_path: Path, old: str, new: str, says: str) -> None:
    (tmp_path / "rig.yaml").write_text(RIG.replace(old, new, 1))
    t = np.arange(400) * 0.1
    rows = "\n".join(f"{a:.2f},{5 + 4 * np.sin(a):.4f},{np.cos(a):.3f}" for a in t)
    (tmp_path / "d.csv").write_text("t,x,u\n" + rows + "\n")
    with pytest.raises(CalibrationInputError, match=says) as caught:
        calibrate([tmp_path / "d.csv"], tmp_path / "rig.yaml", [], tmp_path / "out", plots=False)
    assert "\n" not in str(caught.value)


def test_a_clock_that_runs_backwards_is_one_line(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text(RIG)
    rows = "".join(f"{-0.1 * k:.1f},{k % 7},{k % 5}\n" for k in range(400))
    (tmp_path / "d.csv").write_text("t,x,u\n" + rows)
    with pytest.raises(CalibrationInputError, match=r"d\.csv.*does not advance"):
        calibrate([tmp_path / "d.csv"], tmp_path / "rig.yaml", [], tmp_path / "out", plots=False)


@pytest.mark.parametrize(
    ("body", "says"),
    [
        ("0,9,inf\n1,9,1\n", "column 'u': is infinite in data row 1"),
        ("0,9,1\n0,9,1\n0,9,1\n", "column 't': does not advance"),
        ("0,9,\n1,9,\n", "column 'u': holds no number"),
        ('"0,0";9;1\n', "fields"),
    ],
)
def test_a_table_that_cannot_be_used_names_its_column(tmp_path: Path, body: str, says: str) -> None:
    (tmp_path / "rig.yaml").write_text(RIG)
    (tmp_path / "d.csv").write_text("t,x,u\n" + body)
    with pytest.raises(CalibrationInputError, match=says):
        read_table(tmp_path / "d.csv", load_rig(tmp_path / "rig.yaml"))


def test_a_million_columns_are_refused_at_once(tmp_path: Path) -> None:
    """The reader would take half a minute for their names; the time limit of the tests says the rest."""
    (tmp_path / "rig.yaml").write_text(RIG)
    for name, text in (("d.csv", ""), ("d.log", LOG[: LOG.index("\nt,") + 1])):
        wide = text + ",".join(["t"] * 1_000_000) + "\n" + ",".join(["0"] * 1_000_000) + "\n"
        (tmp_path / name).write_text(wide)
    for read in (
        lambda: read_table(tmp_path / "d.csv", load_rig(tmp_path / "rig.yaml")),
        lambda: read_axis_log(tmp_path / "d.log"),
    ):
        begun_s = monotonic()
        with pytest.raises(CalibrationInputError, match="1000000 columns, at most 4096"):
            read()
        assert monotonic() - begun_s < 10.0


@pytest.mark.slow
def test_a_column_of_next_to_nothing_is_answered(tmp_path: Path) -> None:
    """In units of nobody, 1e-299 V: gains so far from the declared ones that no float squares them."""
    t = np.arange(2000) / 1000
    q = 0.1 * np.sin(5 * t)
    rows = np.column_stack([t, q, (2 * np.cos(5 * t) + q) * 1e-299, q])
    np.savetxt(tmp_path / "d.csv", rows, delimiter=",", header="t,qm,vir,qg", comments="")
    rig = Path(__file__).parents[2] / "calibration" / "rigs" / "emps.yaml"
    calibrate([tmp_path / "d.csv"], rig, [], tmp_path / "out", plots=False)
    assert json.loads((tmp_path / "out" / "report.json").read_text())["verdict"]


def test_columns_of_a_table_may_be_given_by_their_place(tmp_path: Path) -> None:
    (tmp_path / "rig.yaml").write_text(
        RIG.replace("column: t,", "column: 0,").replace("column: u,", "column: 2,")
    )
    (tmp_path / "d.csv").write_text("a,x,b\n0,1,5\n1,2,6\n")
    (run,) = read_table(tmp_path / "d.csv", load_rig(tmp_path / "rig.yaml"))
    assert run.columns["effort"].tolist() == [5, 6]


def test_inflation_is_one_for_columns_at_right_angles_and_large_for_twins() -> None:
    x = np.eye(50)[:, :3]
    assert inflation(x) == pytest.approx([1, 1, 1])
    twins = np.column_stack([x[:, 0], x[:, 0] + 0.01 * x[:, 1], x[:, 2]])
    found = inflation(twins)
    assert found[0] > INFLATION and found[2] == pytest.approx(1)  # 1 / (1 - R^2) = 1e4 by hand


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["steps", "sweep", "ramp"])
@pytest.mark.parametrize("seconds", [2, 5, 10, 20, 40])
def test_a_log_cut_short_never_gets_a_wrong_name(tmp_path: Path, kind: str, seconds: int) -> None:
    (path,) = write_logs(tmp_path, [], [kind])
    lines = path.read_text().splitlines()
    path.write_text("\n".join(lines[: 11 + 100 * seconds]) + "\n")
    assert calibrate([path], None, [], tmp_path / "out", plots=False) == 0
    report = json.loads((tmp_path / "out" / "report.json").read_text())
    # whatever is too short cannot tell, and says what it lacks
    assert report["effects"] == [] and report["verdict"] in ("nothing", "cannot tell")
    if seconds <= 20:
        assert report["verdict"] == "cannot tell"
        assert report["separating_experiment"] and (report["refused"] or seconds <= 5)
    assert report["not_identifiable"]
    for p in report["calibrated"].values():
        assert np.isfinite([p["value"], p["low"], p["high"]]).all()


@pytest.mark.parametrize("place", [1, 2, 3, 4, 5, 7, None], ids=str)
def test_a_column_that_never_changes_warns_of_nothing(tmp_path: Path, place: int | None) -> None:
    """Warnings are errors here: the command answers, with pictures, or refuses with its own error."""
    text = tiny_log(3000)
    for at in [place] if place is not None else range(1, 9):
        text = column(text, at, lambda _: "7")
    (tmp_path / "constant.log").write_text(text)
    try:
        calibrate([tmp_path / "constant.log"], out=tmp_path / "out")
    except CalibrationInputError:
        return
    assert (tmp_path / "out" / "report.html").exists()
