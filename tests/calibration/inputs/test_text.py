"""Text of any origin and the numbers in it: two ways to read say the same, and errors say where."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.errors import CalibrationInputError
from calibration.inputs.text import _slowly, heading, load_text, load_utf8, plain, read_numbers

PATH = Path("x.csv")
FIELDS = st.one_of(
    st.just(""),
    st.floats(allow_nan=False, width=32).map(repr),
    st.integers(-(2**40), 2**40).map(str),
    st.sampled_from(["1e3", "-2.5E-7", ".5", "7.", "+4", "nan", "inf", "-inf"]),
)


@settings(max_examples=100, deadline=None)
@given(value=st.floats(allow_nan=False))
def test_every_number_that_python_writes_is_read_back(value: float) -> None:
    assert plain(repr(value)) == value


@pytest.mark.parametrize("text", ["1_0", "٣", "0x10", "1,5", "--1", "1e", "e5", ".", " 1", "1 ", "true"])
def test_what_is_no_plain_number_is_none(text: str) -> None:
    assert plain(text) is None


@settings(max_examples=80, deadline=None)
@given(
    rows=st.lists(st.tuples(FIELDS, FIELDS, FIELDS), min_size=1, max_size=30), mark=st.sampled_from(",;\t")
)
def test_the_quick_and_the_careful_reader_agree(rows: list[tuple[str, str, str]], mark: str) -> None:
    body = "".join(mark.join(row) + "\n" for row in rows)
    quick = read_numbers(PATH, body, ["a", "b", "c"], 2, mark)
    careful = _slowly(PATH, body, ["a", "b", "c"], 2, mark, {0, 1, 2})
    for name in range(3):
        assert np.array_equal(quick[name], careful[name], equal_nan=True)
    assert len(quick[0]) == len(rows)


@settings(max_examples=40, deadline=None)
@given(count=st.integers(1, 30), at=st.integers(0, 29), word=st.sampled_from(["abc", "1.2.3", "1_0", "°"]))
def test_a_word_names_its_line_and_column_and_only_where_it_is_wanted(count: int, at: int, word: str) -> None:
    at %= count
    lines = [f"{k},{word if k == at else k}" for k in range(count)]
    with pytest.raises(CalibrationInputError) as caught:
        read_numbers(PATH, "\n".join(lines), ["a", "b"], 10)
    assert (caught.value.line, caught.value.column) == (10 + at, "b")
    assert word in str(caught.value)
    found = read_numbers(PATH, "\n".join(lines), ["a", "b"], 10, wanted={0})
    assert found[0].tolist() == list(range(count)) and set(found) == {0}


@pytest.mark.parametrize(
    ("body", "line", "words"),
    [
        ("1,2\n3\n4,5\n", 3, "1 fields, the header row has 2"),
        ("1,2\n3,4,5\n6,7\n", 3, "decimal commas? write points"),
        ("1,2\n# axis: ra\n3,4\n", 3, "a second header? one file holds one run"),
        ("1,2\n1,5,2,5\n3,4\n", 3, "decimal commas? write points"),
    ],
)
def test_a_row_of_another_length_says_so(body: str, line: int, words: str) -> None:
    with pytest.raises(CalibrationInputError) as caught:
        read_numbers(PATH, body, ["a", "b"], 2)
    assert caught.value.line == line
    assert words in str(caught.value)


def test_a_last_row_half_written_is_left_out_and_blank_rows_are_none() -> None:
    found = read_numbers(PATH, "1,2\n\n3,4\n5", ["a", "b"], 2)
    assert found[0].tolist() == [1.0, 3.0]
    assert found[1].tolist() == [2.0, 4.0]


TEXT = st.text(st.characters(exclude_characters="\r\ufeff", exclude_categories=["Cs"]), max_size=200)


@settings(max_examples=60, deadline=None)
@given(text=TEXT, ends=st.sampled_from(["\n", "\r\n", "\r"]), mark=st.booleans())
def test_line_ends_and_the_mark_of_utf_8_do_not_matter(
    tmp_path_factory: pytest.TempPathFactory, text: str, ends: str, mark: bool
) -> None:
    path = tmp_path_factory.mktemp("text") / "a.log"
    path.write_bytes(text.replace("\n", ends).encode("utf-8-sig" if mark else "utf-8"))
    assert load_text(path) == (text, None)
    assert load_utf8(path) == text


def test_a_byte_of_a_code_page_is_found_in_its_line(tmp_path: Path) -> None:
    path = tmp_path / "a.log"
    path.write_bytes(b"one\ntwo\nM\xfcller\n")
    assert load_text(path) == ("one\ntwo\nMüller\n", 3)
    with pytest.raises(CalibrationInputError, match="is not UTF-8 text") as caught:
        load_utf8(path)
    assert caught.value.line == 3


def test_a_file_that_is_not_there_says_so(tmp_path: Path) -> None:
    with pytest.raises(CalibrationInputError, match="cannot be read"):
        load_text(tmp_path / "none.log")


def test_a_commented_header_names_columns_that_any_number_of_blanks_parts() -> None:
    text = "# of a logger\n#t q  tau\n0.00   1.0 2\n0.01  -1.5   3\n"
    got = heading(PATH, text).read(["tau", "t"])
    assert got["tau"].tolist() == [2.0, 3.0] and got["t"].tolist() == [0.0, 0.01]


def test_a_remark_above_numbers_is_no_header() -> None:
    assert heading(PATH, "# 3 runs, all of them good\n1,2\n3,4\n").fields == ["0", "1"]
    assert heading(PATH, "# t, q (rad)\n\n1,2\n3,4\n").fields == ["t", "q (rad)"]
