"""MATLAB's own words for a column, each in a file with structs and cells, and what is said of wrong ones."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.io import savemat

from calibration.errors import CalibrationInputError
from calibration.inputs.matlab import columns_of, read_matlab

T = np.arange(4.0)
X = np.arange(12.0).reshape(4, 3)


def cells(*values: np.ndarray) -> np.ndarray:
    made = np.empty((1, len(values)), dtype=object)
    made[0, :] = values
    return made


CONTENT: dict[str, Any] = {
    "t": T, "x": X, "one": 7.0,
    "log": {"q": 2 * T, "motor": {"i": 3 * T}},
    "trials": cells(X.T, 10 + X.T),
    "many": np.array([(T,), (T + 1,)], dtype=[("q", object)]),
    "word": "text", "c": T + 1j,
}  # fmt: skip


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    made = tmp_path_factory.mktemp("mat") / "a.mat"
    savemat(made, CONTENT)
    return made


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("t", T),
        ("x(:,1)", X[:, 0]),
        ("x( : , 3 )", X[:, 2]),
        ("x(2,:)", X[1]),
        ("x(3)", [6.0]),  # down the columns: 0, 3, 6
        ("log.q", 2 * T),
        ("log.motor.i", 3 * T),
        ("trials{1}(1,:)", X[:, 0]),
        ("trials{2}(3,:)", 10 + X[:, 2]),
        ("many(2).q", T + 1),
        ("many(1).q", T),
    ],
)
def test_a_name_is_a_row_a_column_a_field_or_a_cell(path: Path, name: str, values: Any) -> None:
    (found,) = read_matlab(path, [name])
    assert list(found) == [name] and found[name].tolist() == list(values)


def test_every_cell_is_a_run_and_what_has_one_is_in_all_of_them(path: Path) -> None:
    runs = read_matlab(path, ["t", "trials{*}(2,:)"])
    assert [r["trials{*}(2,:)"].tolist() for r in runs] == [X[:, 1].tolist(), (10 + X[:, 1]).tolist()]
    assert [r["t"].tolist() for r in runs] == [T.tolist()] * 2
    assert read_matlab(path, []) == [{}]


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("y", "column 'y': no such variable ('y'); there are t, x, one, log, trials, many, word, c"),
        ("log.i", "column 'log.i': no such field ('i'); there are q, motor"),
        ("t.q", "column 't.q': no such field ('q'); there are none"),
        ("many.q", "column 'many.q': is an array of 2 structs: index it"),
        ("t{1}", "column 't{1}': {} is for cells; this is no cell array"),
        ("trials{3}(1,:)", "column 'trials{3}(1,:)': there are 2 cells, counted from 1"),
        ("trials{0}(1,:)", "column 'trials{0}(1,:)': there are 2 cells, counted from 1"),
        ("x(0,:)", "column 'x(0,:)': (0,:): give one row (2,:), one column (:,2) or one element (2)"),
        ("x(5,:)", "column 'x(5,:)': (5,:) is outside of its (4, 3)"),
        ("x(:,4)", "column 'x(:,4)': (:,4) is outside of its (4, 3)"),
        ("x", "column 'x': is a matrix of (4, 3): name a row or a column"),
        ("log", "column 'log': is a struct with q, motor: name the part, such as .q or {1}"),
        ("trials", "column 'trials': is a cell array: name the part, such as .q or {1}"),
        ("c", "column 'c': holds complex numbers"),
        ("word", "column 'word': is not numeric"),
        ("1x", "column '1x': is not a name in MATLAB's words, such as q, log.q, x(:,2), Y{2}(1,:)"),
    ],
)
def test_a_wrong_name_says_what_there_is(path: Path, name: str, says: str) -> None:
    with pytest.raises(CalibrationInputError) as caught:
        read_matlab(path, [name])
    assert str(caught.value) == f"{path}: {says}"


def test_columns_of_other_lengths_or_numbers_of_cells_are_refused(path: Path, tmp_path: Path) -> None:
    with pytest.raises(
        CalibrationInputError, match=r"the variables have different lengths: \{'t': 4, 'one': 1\}$"
    ):
        read_matlab(path, ["t", "one"])
    savemat(tmp_path / "b.mat", {"a": cells(T, T, T), "b": cells(T, T)})
    with pytest.raises(CalibrationInputError) as caught:
        read_matlab(tmp_path / "b.mat", ["a{*}", "b{*}"])
    assert str(caught.value) == f"{tmp_path / 'b.mat'}: column 'b{{*}}': has 2 cells, others 3"


def test_what_is_no_matlab_file_says_so(tmp_path: Path) -> None:
    bad = tmp_path / "bad.mat"
    bad.write_bytes(b"t,q\n1,2\n" * 40)
    with pytest.raises(
        CalibrationInputError, match=r"is not a MATLAB file this tool reads; save it with -v7$"
    ):
        read_matlab(bad, ["t"])
    bad.write_bytes(b"MATLAB 7.3 MAT-file".ljust(124) + b"\x00\x02IM" + bytes(400))
    with pytest.raises(
        CalibrationInputError, match=r"is MATLAB 7.3 \(HDF5\); save it with save\(..., '-v7'\)$"
    ):
        read_matlab(bad, ["t"])


@pytest.mark.parametrize(
    ("content", "names"),
    [
        ({"t": T, "x": X, "y": np.zeros(9)}, ["t", "x(:,1)", "x(:,2)", "x(:,3)"]),
        ({"t": T, "x": X.T}, ["t", "x(1,:)", "x(2,:)", "x(3,:)"]),
        ({"x": np.ones((2, 2)), "one": 1.0}, ["x(1,:)", "x(2,:)"]),
        ({"log": {"q": T, "m": {"i": T}}, "w": np.zeros(9)}, ["log.q", "log.m.i"]),
        ({"a": cells(T, T), "b": T}, ["a{*}"]),  # as many names; more cells
        ({"a": np.zeros(5), "b": np.zeros(9)}, ["b"]),  # as many names; longer
        ({"word": "text", "one": 1.0}, []),
        ({"many": CONTENT["many"]}, []),
        ({"cube": np.zeros((2, 3, 4)), "t": T}, ["t"]),
    ],
)
def test_the_columns_of_a_file_are_those_of_one_length(
    tmp_path: Path, content: Any, names: list[str]
) -> None:
    savemat(tmp_path / "c.mat", content)
    assert columns_of(tmp_path / "c.mat") == names


def test_objects_of_an_archive_are_passed_over(tmp_path: Path) -> None:
    np.savez(tmp_path / "A.NPZ.npz", t=T, o=np.array([{}], dtype=object))
    (tmp_path / "A.NPZ.npz").rename(tmp_path / "A.NPZ")
    assert columns_of(tmp_path / "A.NPZ") == ["t"]
    np.save(tmp_path / "b.npy", T)
    (tmp_path / "b.npy").rename(tmp_path / "b.npz")
    with pytest.raises(CalibrationInputError, match=r"is not a NumPy archive of plain arrays \(savez\)$"):
        read_matlab(tmp_path / "b.npz", ["t"])
