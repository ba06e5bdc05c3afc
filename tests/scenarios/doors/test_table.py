"""Rows of the table of doors: what makes a door, of which words, and which stand on the host."""

from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import table
from scenarios.doors.options import ServeOptions
from scenarios.doors.table import ON_HOST, ON_NETWORK, Asked, asked, doors_on, named


@pytest.fixture(autouse=True)
def modules(monkeypatch: pytest.MonkeyPatch) -> None:
    """Any module has a class `Door` and one `Other`, which say what they are made of."""
    made = SimpleNamespace(Door=lambda *given: ("door", *given), Other=lambda *given: ("other", *given))
    monkeypatch.setattr(table, "import_module", {"scenarios.doors.some": made}.__getitem__)


def make(row: dict[str, Any], spec: str) -> Any:
    return table._make(row, "x")(Asked(spec, 3, "word"), "place")


def test_a_door_is_made_of_what_its_row_names() -> None:
    assert make({"door": "some.Door"}, "spec") == ("door", "spec", "place")
    row = {"door": "some.Door", "with": ["number", "token"]}
    assert make(row, "spec") == ("door", 3, "word", "place")


def kinds() -> dict[str, Any]:
    return {"door": {"pty:": "some.Door", "raw": "some.Other"}, "expected": "pty:NAME or raw"}


def test_a_word_may_choose_the_door() -> None:
    """What follows its colon is given on; a word alone has nothing to give."""
    assert make(kinds(), "pty:a:b") == ("door", "a:b", "place")
    assert make(kinds(), "raw") == ("other", "place")


@pytest.mark.parametrize("spec", ["pty:", "pty", "raw:x", "other", ""])
def test_a_word_that_is_none_is_refused(spec: str) -> None:
    with pytest.raises(ValueError) as caught:
        make(kinds(), spec)
    assert str(caught.value) == f'--x "{spec}": expected pty:NAME or raw'


def test_programs_for_astronomers_stand_on_the_host_and_cables_on_the_network() -> None:
    assert {kind.name for kind in ON_HOST} == {"lx200", "alpaca", "console"}
    assert {"can", "serial", "hid", "control"} <= {kind.name for kind in ON_NETWORK}
    assert all(isinstance(kind.repeatable, bool) for kind in (*ON_HOST, *ON_NETWORK))


def test_doors_are_asked_for_in_the_tables_order_and_counted() -> None:
    kind: Any = SimpleNamespace(name="one", make=lambda each, place: (each, place))
    other: Any = SimpleNamespace(name="two", make=lambda each, place: (each, place))
    options = ServeOptions(asked={"two": ("c",), "one": ("a", "b")}, token="word")
    found = [each for _, each in asked((kind, other), options)]
    assert found == [Asked("a", 0, "word"), Asked("b", 1, "word"), Asked("c", 0, "word")]
    made: Any = doors_on((kind, other), options, "place")
    assert made == [(each, "place") for each in found]
    assert named((kind, other, kind), "and") == "--one, --two and --one"
