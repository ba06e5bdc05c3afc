"""A result by itself, many of them counted, and how patient the checks are by default."""

import dataclasses
from typing import Any

import pytest

from bus.conformance import CheckResult, Level, Settings, summary
from bus.conformance.families import FAMILIES, NOTHING, Case, Family, _family
from bus.conformance.result import doubted, judged, told
from bus.protocol import Opcode, Result


def result(level: Level) -> CheckResult:
    return CheckResult(check="c", subject="s", level=level, expected="e", observed="o", duration_s=0.25)


@pytest.mark.parametrize(
    ("level", "passed"),
    [(Level.OK, True), (Level.INFO, True), (Level.ISSUE, False), (Level.ERROR, False)],
)
def test_passed_is_not_an_issue_nor_an_error(level: Level, passed: bool) -> None:
    assert result(level).passed is passed


@pytest.mark.parametrize(
    ("how", "level"), [(judged, Level.ERROR), (doubted, Level.ISSUE)], ids=["judged", "doubted"]
)
def test_a_check_that_failed_is_of_its_level(how: Any, level: Level) -> None:
    bad, good = how("c", "s", False, "e", "o", 0.25), how("c", "s", True, "e", "o", 0.25)
    assert (bad, good) == (result(level), result(Level.OK))
    assert how("c", "s", True, "e", "o").duration_s == 0.0


def test_what_is_told_expects_nothing_and_takes_no_time() -> None:
    assert told("c", "s", "o") == dataclasses.replace(result(Level.INFO), expected="", duration_s=0.0)


def test_a_summary_counts_levels_and_keeps_results() -> None:
    found = summary([result(Level.OK), result(Level.ISSUE), result(Level.ISSUE), result(Level.INFO)])
    row = {"check": "c", "subject": "s", "expected": "e", "observed": "o", "duration_s": 0.25}
    assert found == {
        "format": "schmidt-conformance 2", "passed": True, "checks": 4,
        "ok": 1, "info": 1, "issue": 2, "error": 0,
        "results": [{**row, "level": level} for level in ("ok", "issue", "issue", "info")],
    }  # fmt: skip
    assert not summary([result(Level.OK), result(Level.ERROR)])["passed"]
    assert summary([])["passed"]


def test_the_checks_move_nothing_and_are_as_patient_as_is_written() -> None:
    """Times as the settings' own words have them: two control periods, 2 %, a USB frame of 1 ms."""
    found = Settings()
    assert (found.answer_s, found.period_tolerance, found.stamps_s, found.speed) == (0.010, 0.02, 0.001, 1)
    assert (found.motion, found.flood, found.canopen) == (False, False, False)
    assert (found.listen_s, found.reply_s, found.quiet_s) == (4.2, 1.0, 0.03)
    found.each(result(Level.OK))  # nobody wants to see it


def test_a_row_of_the_table_becomes_a_family() -> None:
    row = {
        "commands": [{"send": "SET_CLASS 3 -1", "right": "OK NOT_ALLOWED", "moves": True},
                     {"send": "STOP", "right": "OK"}],
        "halt": ["STOP", "POWER 0"],
    }  # fmt: skip
    stop = (Opcode.STOP, ())
    assert _family(row) == Family(
        (Case(Opcode.SET_CLASS, (3, -1), (Result.OK, Result.NOT_ALLOWED), True),
         Case(Opcode.STOP, (), (Result.OK,), False)),
        halt=(stop, (Opcode.POWER, (0,))),
    )  # fmt: skip
    assert set(FAMILIES) == {"AXIS", "FOCUS", "DISPLAY"}
    assert Family() == NOTHING and not any(NOTHING)


def test_only_what_is_marked_moves() -> None:
    axis = FAMILIES["AXIS"].commands
    still, moving = ([case for case in axis if case.moves is each] for each in (False, True))
    assert len(still) + len(moving) == len(axis)
    assert all(case.arguments in ((), (0,), (4, 0), (0, 4)) for case in still)
    assert (moving[0].opcode, moving[0].arguments) == (Opcode.POWER, (1,))
    assert (moving[-1].opcode, moving[-1].arguments) == (Opcode.POWER, (0,))
