"""Pages stay readable: no page gets more long sentences or more numbers than language.yaml allows.

Docstrings of the source have no long sentence.
"""

import pytest

from tests.docs import language

ALLOWED = language.allowed()
PAGES = language.pages()


@pytest.mark.parametrize("name", PAGES)
def test_a_page_is_within_its_row(name: str) -> None:
    now = language.measured(PAGES[name].read_text(encoding="utf-8"))
    row = ALLOWED.get(name, ALLOWED["any other page"])
    longest = max(now.long, key=language.words, default="")
    assert len(now.long) <= row["long"], f"{name}: more sentences over 25 words; the longest: {longest}"
    assert now.numbers <= row["numbers"], f"{name}: {now.numbers} numbers per 100 words"


@pytest.mark.parametrize("name", PAGES)
def test_the_reading_path_has_no_long_sentence(name: str) -> None:
    path = (
        "README.md",
        "ARCHITECTURE.md",
        "CONTRIBUTING.md",
        "docs/index.md",
        "docs/guides/",
        "docs/concepts/",
    )
    if name.startswith(path):
        assert not language.measured(PAGES[name].read_text(encoding="utf-8")).long


def test_the_reading_path_takes_an_evening() -> None:
    path = [
        PAGES[name] for name in PAGES if name.startswith(("docs/index.md", "docs/guides/", "docs/concepts/"))
    ]
    assert len(path) > 15
    assert sum(len(page.read_text(encoding="utf-8").split()) for page in path) <= 15_000


def test_a_long_sentence_is_seen_in_prose_and_in_a_table_and_not_in_code() -> None:
    long = "Word " * 26
    assert len(language.measured(f"# Title\n\n{long}.\n").long) == 1
    assert len(language.measured(f"| head | cell |\n|---|---|\n| a | {long} |\n").long) == 1
    assert not language.measured(f"```text\n{long}\n```\n").long
    assert not language.measured("Word " * 25).long


def test_two_sentences_and_two_items_are_not_one() -> None:
    assert not language.measured("Word " * 20 + "end. " + "Word " * 20).long
    assert not language.measured("- " + "word " * 20 + "\n- " + "word " * 20).long


def test_numbers_are_counted_outside_code_and_tables() -> None:
    text = "Word " * 98 + "12.5 and `7 8 9`.\n\n| 1 | 2 |\n"
    assert language.measured(text).numbers == 1.0


def test_the_table_only_falls() -> None:
    table = {"any other page": {"long": 0, "numbers": 0}, "here": {"long": 1, "numbers": 5}}
    now = {"here": language.Measured(long=("x", "y"), numbers=4.0)}
    assert language.tightened(table, now)["here"] == {"long": 1, "numbers": 4.0}
    assert "gone" not in language.tightened(table | {"gone": {"long": 9, "numbers": 9}}, now)


@pytest.mark.parametrize("room", language.ROOMS)
def test_no_docstring_has_a_long_sentence(room: str) -> None:
    assert not language.room_docstrings(room)


def test_a_long_sentence_is_seen_in_every_docstring_and_not_in_other_text() -> None:
    long = "word " * 26
    assert len(language.long_docstrings(f'"""{long}."""\n')) == 1
    assert len(language.long_docstrings(f'class A:\n    """Short. {long}."""\n')) == 1
    assert len(language.long_docstrings(f'async def a():\n    """Short.\n\n    {long}\n    """\n')) == 1
    assert not language.long_docstrings(f'A = """{long}"""\n# {long}\n')


@pytest.mark.parametrize("end", [". ", ": ", "; ", "\n\n"])
def test_two_sentences_of_a_docstring_are_not_one(end: str) -> None:
    half = "word " * 19 + "end"
    assert not language.long_docstrings(f'"""{half}{end}{half}"""\n')
