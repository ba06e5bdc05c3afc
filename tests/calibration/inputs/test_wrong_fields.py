"""Long tables, fields that are no numbers, and files that are none, word by word."""

import os
from pathlib import Path

import numpy as np
import pytest

from calibration.inputs.text import (
    Heading,
    Long,
    _slowly,
    check_file,
    heading,
    load_text,
    read_long,
    read_numbers,
)
from tests.calibration.inputs.test_tables_of_text import NAN, PATH, refused

LONG = Long("signal", "t", "value", 2)


def test_a_long_table_has_a_column_for_every_signal() -> None:
    rows = [f"{t / 10},{name},{value}" for t in range(6) for name, value in (("q", t), ("u", 2 * t))]
    table = heading(PATH, "t,signal,value\n\n" + "\n".join(rows) + "\n\n")
    got, logged = read_long(table, ["u", "t", "q"], LONG, {})
    assert set(got) == {"t", "u", "q"} and set(logged) == {"u", "q"}
    assert got["t"] == pytest.approx([0.0, 0.1, 0.2, 0.3, 0.4, 0.5])
    assert got["u"].tolist() == logged["u"].tolist() == [0.0, 2.0, 4.0, 6.0, 8.0, 10.0]
    cut = heading(PATH, "t,signal,value\n" + "\n".join(rows) + "\n0.6,q\n")
    assert read_long(cut, ["u", "q"], LONG, {})[0]["q"].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert refused(read_long, heading(PATH, "t,name,value\n0,q,1\n"), ["q"], LONG, {}) == (
        "x.csv:1: column 'signal': no such column; the file has t, name, value"
    )


@pytest.mark.parametrize("read", [read_numbers, None])
@pytest.mark.parametrize(
    ("body", "mark", "says"),
    [
        ("1,2\n3,x\n", ",", "x.csv:8: column 'b': 'x' is not a number"),
        ("1;2\n3;4,5\n", ";", "x.csv:8: column 'b': '4,5' is not a number: decimal commas? write points"),
        ("1;2\n3;4,5,6\n", ";", "x.csv:8: column 'b': '4,5,6' is not a number"),
        ("1,2\n3,2024-05-01\n", ",", "x.csv:8: column 'b': '2024-05-01' is not a number: a "
                                     "stamp? the column time "
         "takes 'format: iso'"),
        ("1,2\n3\n5,6\n", ",", "x.csv:8: 1 fields, the header row has 2"),
        ("1,2\n3,4,5\n5,6\n", ",", "x.csv:8: 3 fields, the header row has 2: decimal commas? write points"),
        ("1;2\n3;4;5\n5;6\n", ";", "x.csv:8: 3 fields, the header row has 2"),
        ("1;2\n3;4;5;6\n5;6\n", ";", "x.csv:8: 4 fields, the header row has 2: decimal commas? write points"),
        ("1,2\n# x\n5,6\n", ",", "x.csv:8: 1 fields, the header row has 2: a second header? "
                                 "one file holds one run"),
    ],
)  # fmt: skip
def test_a_wrong_field_names_its_place(read: object, body: str, mark: str, says: str) -> None:
    if read is None:
        assert refused(_slowly, PATH, body, ["a", "b"], 7, mark, [0, 1]) == says
    else:
        assert refused(read, PATH, body, ["a", "b"], 7, mark) == says


def test_the_careful_way_takes_empty_fields_blank_lines_and_a_row_half_written() -> None:
    found = _slowly(PATH, "1,\n\n \t\n nan,-inf\n7", ["a", "b"], 2, ",", [0, 1])
    assert np.array_equal(found[0], [1.0, NAN], equal_nan=True)
    assert np.array_equal(found[1], [NAN, -np.inf], equal_nan=True)
    tabs = _slowly(PATH, "1\t2\n\t\n", ["a", "b"], 2, "\t", [1])
    assert set(tabs) == {1} and np.array_equal(tabs[1], [2.0, NAN], equal_nan=True)
    assert refused(read_numbers, PATH, "\ufeff1,2\n", ["a", "b"], 2) == (
        "x.csv:2: column 'a': '\ufeff1' is not a number"
    )
    assert _slowly(PATH, "7", ["a", "b"], 2, ",", [0])[0].shape == (0,)


def test_only_a_regular_file_is_read(tmp_path: Path) -> None:
    check_file(tmp_path / "none")
    (tmp_path / "a").write_text("x")
    check_file(tmp_path / "a")
    assert refused(check_file, tmp_path) == f"{tmp_path}: cannot be read (Is a directory)"
    os.mkfifo(tmp_path / "pipe")
    assert refused(check_file, tmp_path / "pipe") == f"{tmp_path / 'pipe'}: cannot be read (no regular file)"
    assert (
        refused(load_text, tmp_path / "none")
        == f"{tmp_path / 'none'}: cannot be read (No such file or directory)"
    )


def test_a_heading_knows_where_its_names_are() -> None:
    h = Heading(PATH, ["1 2"], ["0", "1"], 0, " ", 0)
    assert h.read([1, 0])["1"].tolist() == [2.0]
