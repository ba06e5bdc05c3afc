"""The page of the measured drives, from answers that are made up."""

import math
import re
from dataclasses import replace
from datetime import date

import pytest

from tests.measured.cases import CASES
from tests.measured.page import SOURCES, page
from tests.measured.truth import MISSED, RIGHT, Answer

GOOD = Answer(
    key="emps", verdict="found", judged=RIGHT, why="", unit="N", before=2.0, after=1.0, floor=0.9, own=2.0,
    seconds=5.0, effects=("gear_mesh motor h6", "gear_mesh motor h2", "play (or presliding)"), experiment="",
)  # fmt: skip
BAD = replace(
    GOOD, key="phd2_02", verdict="nothing", judged=MISSED, why="no play", after=2.0, floor=0.1, own=math.nan,
    seconds=90.0, effects=(),
)  # fmt: skip


def test_what_is_missed_comes_first_and_is_counted() -> None:
    text = page([GOOD, BAD], date(2026, 1, 2))
    missed, found = text.split("## Missed\n")[1].split("\n## Found\n")[0], text.split("\n## Found\n")[1]
    assert "`phd2_02` is judged **missed**: no play" in missed
    assert "1 of 2 errors stay above 1.2 times their noise floor" in missed and "20 floors" in missed
    assert "does not fall in `phd2_02`" in missed
    assert "`phd2_02`: more processor time than is meant, 90 s at most." in missed
    assert "**1 of 2 answers are right**" in found
    assert "falls in 1 of 2, and comes down to its floor in 1." in found
    assert "| gear_mesh motor h6, h2; play (or presliding) |" in found
    assert "2026-01-02" in text


def test_every_case_has_a_source() -> None:
    for case in CASES:
        assert any(case.key.startswith(source.keys) for source in SOURCES), case.key
    with pytest.raises(ValueError, match="no such data"):
        page([replace(GOOD, key="else")], date(2026, 1, 2))


def test_every_row_has_all_cells() -> None:
    rows = re.findall(r"^\| `(?:emps|phd2_02)` \| N \|.*$", page([GOOD, BAD], date(2026, 1, 2)), re.MULTILINE)
    assert [len(row.split("|")) for row in rows] == [10, 10]
