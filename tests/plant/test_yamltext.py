"""Text from outside: what is refused before anything is built from it, and in which line."""

import os
from pathlib import Path

import pytest

from plant import yamltext
from plant.yamltext import TextError, beside, check_regular, check_yaml, nearest, read_text


def refused(text: str) -> TextError:
    with pytest.raises(TextError) as caught:
        check_yaml(text)
    return caught.value


def test_a_file_may_be_as_long_as_the_limit(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_bytes(b"\xef\xbb\xbfabcdefg")  # the mark of UTF-8 is no text
    assert read_text(file, 10) == "abcdefg"
    with pytest.raises(TextError, match="is longer than 9 bytes"):
        read_text(file, 9)
    with pytest.raises(FileNotFoundError):
        read_text(tmp_path / "none.yaml")


def test_the_project_s_files_fit_a_hundred_times(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_bytes(b"#" * 4_000_000)
    assert len(read_text(file)) == 4_000_000
    file.write_bytes(b"#" * 4_000_001)
    with pytest.raises(TextError, match="is longer than 4000000 bytes"):
        read_text(file)


def test_what_is_no_text_is_said_with_its_line(tmp_path: Path) -> None:
    file = tmp_path / "a.yaml"
    file.write_bytes(b"one\ntwo\n\xff")
    with pytest.raises(TextError, match="it is not UTF-8 text") as caught:
        read_text(file)
    assert (caught.value.line, caught.value.what) == (3, "cannot be read: it is not UTF-8 text")


def test_a_pipe_and_an_impossible_name_are_refused(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe")
    for path, words in (
        (tmp_path / "pipe", "^cannot be read: it is no regular file$"),
        (tmp_path, "^cannot be read: it is no regular file$"),
        (tmp_path / "a\0b", "^no file can have this name$"),
        (tmp_path / ("a" * 5000), "^cannot be read: File name too long$"),
    ):
        with pytest.raises(TextError, match=words):
            check_regular(path)
        with pytest.raises(TextError, match=words):
            read_text(path)
    check_regular(tmp_path / "none")  # to be made


def test_fifty_brackets_may_be_open() -> None:
    check_yaml("[" * 50 + "]" * 50)
    check_yaml("- [1]\n" * 60)  # one after the other is not within
    assert refused("[" * 51 + "]" * 51).what == "nested too deeply"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("- 1\n- 2\n", 3),
        ("a: 1\nb: 2\n", 5),
        ("- &a 1\n- *a\n- *a\n", 4),
        ("- &a [1, 2, 3]\n- *a\n- *a\n- 5\n", 14),
        ("- &a [1, 2, 3]\n- &a 1\n- *a\n", 7),  # an anchor stands for the last that has it
        ("- 7\n- &a [1, [2, 3]]\n- &b [*a, *a]\n- *b\n", 29),
    ],
)
def test_an_alias_counts_as_what_it_stands_for(
    text: str, values: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(yamltext, "MAX_VALUES", values)
    check_yaml(text)
    monkeypatch.setattr(yamltext, "MAX_VALUES", values - 1)
    assert refused(text).what.startswith(f"names more than {values - 1} values")


def test_aliases_of_aliases_are_refused_before_they_are_built() -> None:
    lines = ["a: &a [x, x, x, x, x, x, x, x, x, x]"]
    lines += [
        f"{new}: &{new} [{', '.join([f'*{old}'] * 10)}]" for old, new in zip("abcdef", "bcdefg", strict=True)
    ]
    assert refused("\n".join(lines)).line == 5  # 10, 100, 1000, 10 000; then 100 000 and more


def test_an_alias_within_itself_is_refused() -> None:
    error = refused("a: 1\nb: &b\n  - 1\n  - [*b]\n")
    assert (error.what, error.line) == ("the alias 'b' holds itself", 4)
    check_yaml("a: &a [1]\nb: [*a]\n")


def test_a_key_is_given_once_in_its_mapping() -> None:
    error = refused("a: 1\nb:\n  a: 2\n  c: c\na: 3\n")
    assert (error.what, error.line) == ("'a' is given twice (first in line 1)", 5)
    check_yaml("[a, a]")
    check_yaml("b: b\na: b\n")  # a value is no key


def test_what_is_not_yaml_is_said_with_its_line() -> None:
    error = refused("a: 1\nb: }\n")
    assert error.line == 2 and error.what.startswith("is not YAML: ")
    for text in ("a: \x07", "a: \x00\n"):
        assert refused(text).line == 1
    assert refused('x: 1\na: "\\a"').line == 2
    assert "is no character of a text" in refused('x: 1\na: "\\a"').what
    check_yaml('a: "\\t\\n\\r"')


def test_a_number_that_no_float_holds_is_refused() -> None:
    for head in ("", "-", "0x", "+0b"):
        check_yaml(f"a: {head}{'1' * (250 - len(head))}")
        error = refused(f"b: 1\na: {head}{'1' * 251}")
        assert (error.what, error.line) == (f"a number of {251 + len(head)} digits is too long", 2)
    check_yaml("a: " + "g" * 300)


@pytest.mark.parametrize(("others", "more"), [(0, 0), (19, 0), (20, 1), (25, 6)])
def test_a_screen_of_mistakes_is_told_and_how_many_more_there_are(others: int, more: int) -> None:
    """Twenty in all: the error itself, and 19 beside it."""
    found = beside(ValueError("first"), [f"mistake {k}" for k in range(others)], "file")
    told = [f"mistake {k}" for k in range(min(others, 19))]
    assert getattr(found, "__notes__", []) == told + [f"file: and {more} mistakes more"] * bool(more)


def test_the_nearest_word_is_offered_or_all() -> None:
    assert nearest("Inertya", ["inertia", "gear"]) == "did you mean 'inertia'?"
    assert nearest("xyz", ["inertia", "gear"]) == "use one of inertia, gear"
    assert nearest("xyz", []) == "none is allowed here"


def test_a_hundred_thousand_values_may_be_named() -> None:
    check_yaml("[" + "1," * 99_999 + "]")
    assert refused("[" + "1," * 100_000 + "]").what.startswith("names more than 100000 values")


def test_an_error_says_its_line_where_it_has_one() -> None:
    assert str(TextError("is wrong")) == "is wrong" and TextError("is wrong").line is None
    assert str(TextError("is wrong", 3)) == "line 3: is wrong"


def test_what_the_reader_refuses_is_one_line() -> None:
    found = refused("a: \x07").what
    assert found.startswith("is not YAML: ") and "\n" not in found and "position" not in found
    assert len(found) > len("is not YAML: ")


@pytest.mark.parametrize(
    ("character", "good"),
    [("\ud7ff", True), ("\ud800", False), ("\udfff", False), ("\ue000", True), ("\x1f", False), (" ", True)],
)
def test_halves_of_characters_are_no_text(character: str, good: bool) -> None:
    if good:
        yamltext._check_scalar(character, 1)
        return
    with pytest.raises(TextError, match=r"line 1: .* is no character of a text"):
        yamltext._check_scalar(character, 1)


def test_a_text_with_a_colon_is_told_to_need_quotes() -> None:
    with pytest.raises(TextError) as caught:
        check_yaml("rig: bench: left motor\n")
    assert caught.value.what.endswith("(a text with a colon needs quotes)") and caught.value.line == 1
