"""Files without a rig file: what their columns hold, and what a name says of channel and unit."""

from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from calibration.errors import CalibrationInputError
from calibration.inputs.loose import Loose, Said, read_loose, said


def read(folder: Path, text: str) -> Loose:
    (folder / "a.csv").write_text(text, encoding="utf-8")
    return read_loose(folder / "a.csv")


def refused(path: Path) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        read_loose(path)
    return str(caught.value).removeprefix(f"{path}")


def test_columns_are_called_by_their_names_or_their_places(tmp_path: Path) -> None:
    found = read(tmp_path, 't,x,x,"3",u\n0,1,2,3,4\n1,5,6,7,8\n')
    assert {c: x.tolist() for c, x in found.columns.items()} == {
        "t": [0.0, 1.0], 1: [1.0, 5.0], 2: [2.0, 6.0], 3: [3.0, 7.0], "u": [4.0, 8.0]
    }  # fmt: skip
    assert (found.stamp, found.fields, found.words) == (None, {}, [])
    bare = read(tmp_path, "0,1\n1,5\n")
    assert bare.fields == {"names": ["column1", "column2"]} and set(bare.columns) == {"column1", "column2"}
    dated = read(tmp_path, "2024-05-01,1\n2024-05-02,5\n")
    assert dated.fields == {"names": ["column1", "column2"]} and dated.stamp == "column1"
    commented = read(tmp_path, "# t, q\n0,1\n1,5\n")
    assert commented.fields == {} and set(commented.columns) == {"t", "q"}


def test_words_are_told_and_stamps_are_seconds(tmp_path: Path) -> None:
    found = read(tmp_path, "when,q,mode,more\n2024-05-01,1,a,b\n2024-05-02,2,a,\n")
    assert found.stamp == "when" and np.diff(found.columns["when"]).tolist() == [86400.0]
    assert found.words == ["mode", "more"] and set(found.columns) == {"when", "q"}
    mixed = read(tmp_path, "when,q\n2024-05-01,1\nnever,2\n")
    assert mixed.stamp is None and mixed.words == ["when"]
    late = "\n".join(["t,q", *(f"{k},2024-05-01" for k in range(200)), "200,never"])
    (tmp_path / "a.csv").write_text(late)
    assert read_loose(tmp_path / "a.csv").words == ["q"]


def test_a_table_of_nothing_but_words_or_stamps_is_refused_with_its_first_word(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text("a,b\nx,y\n")
    assert refused(path) == ":2: column 'a': 'x' is not a number"
    path.write_text("when,b,c\n2024-05-01,y,z\n")
    assert refused(path) == ":2: column 'b': 'y' is not a number"


def long(names: list[str], readings: int = 6) -> str:
    rows = [f"{k / 10},{name},{k}" for k in range(readings) for name in names]
    return "\n".join(["t,signal,value", *rows]) + "\n"


def test_a_row_per_reading_is_a_long_table(tmp_path: Path) -> None:
    found = read(tmp_path, long(["q", "u"]))
    assert found.fields == {"long": {"name": "signal", "value": "value"}} and found.stamp is None
    assert {c: x.tolist()[:2] for c, x in found.columns.items()} == {
        "t": [0.0, 0.1],
        "q": [0.0, 1.0],
        "u": [0.0, 1.0],
    }
    dated = "".join(f"2024-05-01T00:00:0{k},{n},{k}\n" for k in range(6) for n in "qu")
    for head, row in (("value,signal,when", True), ("when,signal,value", False)):
        lines = [",".join(line.split(",")[::-1] if row else line.split(",")) for line in dated.splitlines()]
        found = read(tmp_path, "\n".join([head, *lines]) + "\n")
        assert found.stamp == "when" and set(found.columns) == {"when", "q", "u"}
        assert np.diff(found.columns["when"]).tolist() == [1.0] * 5


@pytest.mark.parametrize(
    ("text", "is_long"),
    [
        (long([f"s{k}" for k in range(33)]), True),  # in two hundred rows
        (long([f"s{k}" for k in range(64)], 4), True),
        (long([f"s{k}" for k in range(65)], 4), False),
        (long(["q"]), False),
        ("t,signal,value\n" + "".join(f"{k},{'qu'[k // 10 % 2]},{k}\n" for k in range(40)), False),  # seldom
        ("t,signal,value\n" + "".join(f"{k},{'qu'[k // 3 % 2]},{k}\n" for k in range(40)), True),
        ("t,signal,value,more\n" + "".join(f"{k},{'qu'[k % 2]},{k},1\n" for k in range(40)), False),
    ],
)
def test_a_signals_name_is_often_another_one(tmp_path: Path, text: str, is_long: bool) -> None:
    assert ("long" in read(tmp_path, text).fields) is is_long


def test_a_long_table_needs_names_of_its_columns(tmp_path: Path) -> None:
    """A rig file has the value's name there, and no place."""
    for text in (long(["q", "u"]).partition("\n")[2], long(["q", "u"]).replace("value", "3")):
        assert "long" not in read(tmp_path, text).fields


def test_files_that_need_no_rig_file_or_none_can_be_drafted_for_are_refused(tmp_path: Path) -> None:
    for name in ("a.mf4", "b.MCAP"):
        (tmp_path / name).write_text("x")
        assert (
            refused(tmp_path / name) == ": is a recording: give its channels in a rig file, none is drafted"
        )
    for text in ("# format: axis-log 1\n", "PHD2 version 2\n"):
        (tmp_path / "a.log").write_text(text)
        assert refused(tmp_path / "a.log") == ": says itself what it holds: schmidt calibrate a.log --out DIR"
    assert refused(tmp_path) == ": cannot be read (Is a directory)"


def test_matlabs_columns_are_those_of_one_length(tmp_path: Path) -> None:
    savemat(tmp_path / "A.mat", {"t": np.arange(4.0), "x": np.ones((4, 2)), "word": "x"})
    (tmp_path / "A.mat").rename(tmp_path / "A.MAT")
    assert set(read_loose(tmp_path / "A.MAT").columns) == {"t", "x(:,1)", "x(:,2)"}
    savemat(tmp_path / "b.mat", {"word": "x"})
    assert read_loose(tmp_path / "b.mat") == Loose({})


@pytest.mark.parametrize(
    ("name", "told"),
    [
        (3, Said()),
        ("", Said()),
        ("Position [mm]", Said("position", "mm")),
        ("theta (deg)", Said("position", "deg", angle=True)),
        ("q(3)", Said("position", angle=True)),  # a place, and no unit
        ("q(:,3)", Said("position", angle=True)),
        ("torque (furlong)", Said("force", "furlong")),
        ("speed_deg_s", Said("velocity", "deg/s")),
        ("speed_deg_per_s", Said("velocity", "deg/s")),
        ("force_N", Said("force", "N")),
        ("effort_mA", Said("effort", "A", 1e-3)),
        ("normal_kN", Said("normal", "kN")),
        ("speed_rad", Said("position", "rad")),  # the unit knows better
        ("N", Said("count")),
        ("rpm", Said("velocity", "turn/s", 1 / 60)),
        ("in", Said("", "", asked=True)),
        ("goal_in", Said("", "", asked=True)),
        ("run", Said("label")),
        ("run_speed", Said("velocity")),
        ("sampleIndex", Said("")),
        ("index", Said("count")),
        ("motorPos", Said("position")),
        ("Temp [°C]", Said("temperature", "degC")),
    ],
)
def test_what_a_name_says(name: str | int, told: Said) -> None:
    found = said(name)
    assert found[:2] + found[3:] == told[:2] + told[3:] and found.scale == pytest.approx(told.scale)
