"""Targets of the mutation runs: every module of a room has tests, and those tests are there."""

from pathlib import Path

import pytest

from tests.mutation.ratchet import fallen, floors, key, reasons
from tests.mutation.targets import AIMS, TARGETS, modules, room_of


@pytest.mark.parametrize("room", AIMS)
def test_every_module_of_a_room_has_tests_that_are_there(room: str) -> None:
    found = modules(room)
    assert found
    for path, tests in found.items():
        assert tests and all(Path(each.partition("::")[0]).exists() for each in tests), path


def test_every_target_is_there_and_in_a_room() -> None:
    for path in [*TARGETS, *floors(), *(each.partition(":")[0] for each in reasons())]:
        assert Path(path).is_file() and room_of(path), path


def test_a_share_below_its_floor_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("tests.mutation.ratchet.floors", lambda: {"a.py": 90.0})
    assert fallen({"a.py": 90.0, "b.py": 0.0}) == []
    assert fallen({"a.py": 89.9}) == ["a.py: 89.9 % killed, was 90 %"]


def test_a_survivor_is_known_without_its_line() -> None:
    assert key("a.py", "12: compare: a < b -> a <= b") == key("a.py", "99: compare: a < b -> a <= b")
