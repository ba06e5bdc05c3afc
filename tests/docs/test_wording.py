"""No count of wording.yaml rises: long sentences by the strict rule, messages, numbers, private words."""

import pytest

from tests.docs import wording

FOUND = wording.findings()
ALLOWED = wording.allowed()


@pytest.mark.parametrize("measure", sorted(FOUND))
def test_no_more_than_the_table_allows(measure: str) -> None:
    found = FOUND[measure]
    assert len(found) <= ALLOWED.get(measure, 0), "\n".join(found)


def test_every_row_of_the_table_is_a_measure() -> None:
    assert set(ALLOWED) <= set(FOUND), "python -m tests.docs.wording --tighten"


def test_a_colon_ends_no_sentence() -> None:
    assert wording.long_sentences("word " * 13 + "end: " + "word " * 13)
    assert not wording.long_sentences("word " * 13 + "end. " + "word " * 13)
    assert not wording.long_sentences("word " * 13 + "end\n\n" + "word " * 13)


def test_docstrings_of_attributes_are_docstrings_and_no_messages() -> None:
    source = 'A = 1\n"""Of an attribute."""\nB = f"a message {A} here"\n'
    assert wording.docstrings(source) == ["Of an attribute."]
    assert wording.messages(source) == ["a message value here"]


@pytest.mark.parametrize(
    ("text", "count"),
    [
        ("It takes 3 s.", 0),
        ("It takes 3 s of 20 m.", 1),
        ("It meets 10 of 15 rows.", 0),
        ("It takes 3 s (of 7).", 0),
        ("From 1 to 3 s, and 20 m (of 7).", 1),
        ("Measured on 2026-11-24 with 3 boards.", 0),
        ("The type is `0x10`, and 3 frames come.", 0),
        ("| 1 | 2 |", 0),
    ],
)
def test_a_sentence_holds_one_number(text: str, count: int) -> None:
    assert len(wording.several_numbers(text)) == count


def test_private_words_are_words() -> None:
    assert wording.private("It was told and mended.") == ["told", "mended"]
    assert not wording.private("An amended toldo, of course.")
