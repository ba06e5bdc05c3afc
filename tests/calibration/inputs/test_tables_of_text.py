"""Where a table of text begins, what its columns are called, and every complaint word by word."""

from pathlib import Path

import numpy as np
import pytest

from calibration.errors import CalibrationInputError
from calibration.inputs.text import (
    heading,
)

PATH = Path("x.csv")
NAN = float("nan")


def at(text: str, *names: str, delimiter: str | None = None) -> tuple[list[str], int, str, int]:
    h = heading(PATH, text, names, delimiter)
    return h.fields, h.first, h.mark, h.at


def refused(call: object, *more: object) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        call(*more)  # type: ignore[operator]
    return str(caught.value)


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("t,q\n1,2\n", (["t", "q"], 1, ",", 0)),
        ('"t";"q"\n1;2\n', (["t", "q"], 1, ";", 0)),
        ("t\tq\n1\t2\n", (["t", "q"], 1, "\t", 0)),
        ("t;q,x\n1;2,5\n", (["t", "q,x"], 1, ";", 0)),
        ("  t   q\n 1  2\n", (["t", "q"], 1, " ", 0)),
        ("1,2\n3,4\n", (["0", "1"], 0, ",", 0)),
        ("1,2\n", (["0", "1"], 0, ",", 0)),
        ("1,\n3,4\n", (["1", ""], 1, ",", 0)),  # no row of numbers
        ("% a remark\n\n# t, q\n1,2\n", (["t", "q"], 3, ",", 2)),
        ("# t, q, x\n1,2\n", (["0", "1"], 1, ",", 1)),
        ("# t, t\n1,2\n", (["0", "1"], 1, ",", 1)),
        ("# t, the place of it\n1,2\n", (["0", "1"], 1, ",", 1)),
        ("# t, q deg\n1,2\n", (["t", "q deg"], 1, ",", 0)),
        ("# 3, q\n1,2\n", (["0", "1"], 1, ",", 1)),
        ("# t, q\n# 3 runs\n1,2\n", (["0", "1"], 2, ",", 2)),
        ("# t\n1\n2\n", (["0"], 1, " ", 1)),
        ("% t (8Hz),q\n% [s],(deg)\n1,2\n", (["t (8Hz)", "q"], 2, ",", 1)),  # a row of units
        ("% Date:,today\n% t,q\n1,2;\n3,4; \n", (["t", "q"], 2, ",", 1)),  # rows that end in `;`
        ("t,q\n1,2;\n3,4;\n", (["t", "q"], 1, ",", 0)),
        ("t,q\n1,2;3\n", (["t", "q"], 1, ",", 0)),
        ("Operator: N. N.\nt,q\n1,2\n3,4\n", (["t", "q"], 2, ",", 1)),
        ("Operator: N. N.\nt,q\n1,2\n", (["t", "q"], 2, ",", 1)),
        ("a, b, c, d\nt,q\n1,2\n3,4\n5", (["t", "q"], 2, ",", 1)),  # the last row may be cut off
        ("a remark\nanother\n\nt,q\n\n1,2\n3,4\n", (["t", "q"], 5, ",", 3)),
        ("a remark\n1,2\n3,4\n", None),
    ],
)
def test_a_table_begins_where_its_names_do(text: str, found: tuple[list[str], int, str, int] | None) -> None:
    if found is None:
        assert refused(heading, PATH, text) == "x.csv:2: 1 fields, 2 names"
    else:
        assert at(text) == found


def test_words_behind_the_fields_that_have_names_are_passed_over() -> None:
    """As a monitor's log has alarms behind some values; a number there is a column without a name."""
    text = "axis:x 2.5 HIHI MAJOR\naxis:u 3\n"
    table = heading(PATH, text, ("name", "value"), " ")
    assert table.lines == ["axis:x 2.5", "axis:u 3"]
    assert refused(heading, PATH, "axis:x 2.5 7\n", ("name", "value"), " ").startswith("x.csv:1: 3 fields")


def test_names_and_a_delimiter_that_are_given_come_first() -> None:
    assert at("1,2\n3,4\n", "a", "b") == (["a", "b"], 0, ",", 0)
    assert at("t,q\n1,2\n", "a", "b")[:2] == (["a", "b"], 0)
    assert at("1,5;2\n", "a", "b", delimiter=";")[:3] == (["a", "b"], 0, ";")
    assert refused(heading, PATH, "1,2\n", ("a",)) == "x.csv:1: 2 fields, 1 names: every column needs one"


@pytest.mark.parametrize("mark", [",", ";", "\t"])
def test_rows_that_end_in_the_delimiter_have_no_column_more(mark: str) -> None:
    """As many a microcontroller prints them; a last line that is cut off is left out."""
    text = "t,q\n1,2,\n3,4, \n5,6\n7,,\n8".replace(",", mark)
    found = heading(PATH, text).read(["t", "q"])
    assert found["t"].tolist() == [1, 3, 5, 7] and found["q"].tolist()[:3] == [2, 4, 6]
    assert np.isnan(found["q"][3])
    assert heading(PATH, "t,q,\n1,2,\n".replace(",", mark)).fields == ["t", "q", ""]


def test_a_row_that_ends_so_and_has_one_more_is_refused() -> None:
    table = heading(PATH, "t,q\n1,2,\n3,4,5\n6,7,\n")
    assert refused(table.read, ["t", "q"]).startswith("x.csv:3: 3 fields, the header row has 2")


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("", "x.csv: has no data rows"),
        ("# a\n\n% b\n", "x.csv:3: has no data rows"),
        ("t,q\n", "x.csv:1: has no data rows"),
        ("t,q\n1,2,3\n", "x.csv:2: 3 fields, 2 names: every column needs one"),
        (
            ",".join("abc" + str(k) for k in range(4097)) + "\n",
            "x.csv:1: 4097 columns, at most 4096: is it transposed?",
        ),
    ],
)
def test_a_text_without_rows_is_no_table(text: str, says: str) -> None:
    assert refused(heading, PATH, text) == says


def test_as_many_columns_as_there_may_be_are_read() -> None:
    names = [f"c{k}" for k in range(4096)]
    assert heading(PATH, ",".join(names) + "\n" + ",".join("1" * 4096) + "\n").fields == names


TABLE = heading(PATH, "t,q,q,u\n0,1,2,3\n1,4,,6\n")


@pytest.mark.parametrize(
    ("column", "says"),
    [
        (4, "x.csv:1: column '4': there are 4 columns, counted from 0"),
        (-1, "x.csv:1: column '-1': there are 4 columns, counted from 0"),
        ("q", "x.csv:1: column 'q': stands more than once (at 1, 2, from 0): give the place in its stead"),
        ("v", "x.csv:1: column 'v': no such column; the file has t, q, q, u"),
    ],
)
def test_a_column_that_is_not_there_says_which_are(column: str | int, says: str) -> None:
    assert refused(TABLE.place, column) == says
    bare = heading(PATH, "# x\n1,2\n")
    assert refused(bare.place, "v") == (
        "x.csv:2: column 'v': no such column; the file has no header row and 2 columns, named 0, 1 …"
    )
    assert refused(bare.place, "v", True).endswith("the file has 0, 1")


def test_columns_are_read_by_name_or_place_and_errors_by_the_name_that_was_used() -> None:
    assert [TABLE.place(c) for c in ("t", 0, 3, "u")] == [0, 0, 3, 3]
    got = TABLE.read(["u", 2])
    assert got["u"].tolist() == [3.0, 6.0] and got["2"][0] == 2.0 and np.isnan(got["2"][1])
    bad = heading(PATH, "t,q\n0,1\n1,x\n")
    assert refused(bad.read, ["q"]) == "x.csv:3: column 'q': 'x' is not a number"
    assert refused(bad.read, [1]) == "x.csv:3: column '1': 'x' is not a number"
    assert bad.read(["t"])["t"].tolist() == [0.0, 1.0]


def test_stamps_of_two_columns_are_seconds() -> None:
    table = heading(PATH, "day,clock,q\n2024-05-01,00:00:01,5\n2024-05-01,00:00:03,6\n")
    got = table.read(["day", "q"], {"day": ("iso", "clock")})
    assert np.diff(got["day"]).tolist() == [2.0] and got["q"].tolist() == [5.0, 6.0]
    alone = heading(PATH, "at,q\n2024-05-01,5\n2024-05-02,6\n").read(["at"], {"at": ("iso", "")})
    assert np.diff(alone["at"]).tolist() == [86400.0]
    wrong = heading(PATH, "at,q\nnow,5\n")
    assert refused(wrong.read, ["at"], {"at": ("iso", "")}) == (
        "x.csv:2: column 'at': 'now' is no stamp of format 'iso'"
    )


def test_json_is_a_table_between_tabs() -> None:
    h = heading(PATH, '{"t": 0, "q": "1,5"}\n{"t": 1, "q": "2"}\n')
    assert (h.fields, h.mark, h.first) == (["t", "q"], "\t", 1)
