"""The journal of a campaign: its folder, its text, and what it counts as done."""

from pathlib import Path

import pytest

from host.logs.files import LogError
from scenarios.campaign import table
from scenarios.language.document import ScenarioError


def test_a_journal_makes_its_folders_and_counts_what_is_not_lost(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path / "a" / "b", resume=False)
    journal.add({"key": "a", "index": 0, "failure": "zu spät"})
    journal.add({"key": "b", "index": 1, "failure": "", "lost": True})
    journal.close()
    assert journal.done == {"a"}
    assert "zu spät" in journal.path.read_text(encoding="utf-8")


def test_a_journal_that_is_no_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ScenarioError, match="it is no regular file"):
        list(table.rows(tmp_path))


@pytest.mark.parametrize(("number", "count"), [((1 << 63) - 1, 1), (-(1 << 63) + 1, 1), (1 << 63, 0)])
def test_a_whole_number_has_to_fit_a_column(number: int, count: int, tmp_path: Path) -> None:
    path = tmp_path / table.JOURNAL
    path.write_text(f'{{"key": "a", "index": 0, "failure": "", "x": {number}}}\n')
    assert len(list(table.rows(path))) == count


def test_a_column_with_a_number_and_a_text_is_text(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    for key, one, two in (("a", 1, True), ("b", "two", 3), ("c", None, None)):
        journal.add({"key": key, "index": 0, "failure": "", "one": one, "two": two})
    journal.close()
    found = table.read(table.write(tmp_path))
    assert found["one"] == ["1", "two", None]
    assert found["two"] == ["True", "3", None]


def test_a_column_of_whole_numbers_stays_one_and_an_empty_one_is_kept(tmp_path: Path) -> None:
    journal = table.Journal(tmp_path, resume=False)
    for key, one in (("a", 1), ("b", None)):
        journal.add({"key": key, "index": 0, "failure": "", "one": one, "none": None})
    journal.close()
    found = table.read(table.write(tmp_path))
    assert [type(each) for each in found["one"]] == [int, type(None)]
    assert found["none"] == [None, None]


def test_a_table_that_cannot_be_written_is_named(tmp_path: Path) -> None:
    (tmp_path / table.JOURNAL).write_text('{"key": "a", "index": 0, "failure": ""}\n')
    (tmp_path / table.TABLE).mkdir()
    with pytest.raises(LogError) as caught:
        table.write(tmp_path)
    _, _, why = str(caught.value).partition("runs.parquet: cannot be written: ")
    assert why and why != "None" and not why.startswith("[Errno")
