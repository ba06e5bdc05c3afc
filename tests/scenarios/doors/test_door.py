"""A door's keeper: what breaks is told once, closed, and opened again a second later."""

from typing import Any

import can
import pytest

from scenarios.doors import door
from scenarios.doors.door import Keeper, counted


class Breaking:
    """A door whose calls raise what a test sets."""

    name = "--x"

    def __init__(self) -> None:
        self.errors: dict[str, Exception | None] = {}
        self.asked: list[Any] = []

    def _call(self, word: str, *given: int) -> None:
        self.asked.append((word, *given))
        if (error := self.errors.get(word)) is not None:
            raise error

    def open(self) -> None:
        self._call("open")

    def poll(self, now_ns: int) -> None:
        self._call("poll", now_ns)

    def close(self) -> None:
        self._call("close")

    def state(self) -> str:
        return ""


class Desk:
    """clock: wall time, s."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.clock, self.said, self.door = 100.0, list[str](), Breaking()
        monkeypatch.setattr(door, "monotonic", lambda: self.clock)
        self.keeper = Keeper(self.door, self.said.append)

    def poll(self, clock: float, **errors: Exception | None) -> list[Any]:
        """What the door is asked at this time."""
        self.clock = clock
        self.door.errors |= errors
        self.door.asked.clear()
        self.keeper.poll(7)
        return list(self.door.asked)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    desk = Desk(monkeypatch)
    desk.keeper.open()
    return desk


def test_counts_are_told_without_nothing() -> None:
    assert counted((3, "clients"), (0, "lost"), (2, "refused")) == "3 clients, 2 refused"
    assert counted((0, "clients")) == counted() == ""


def test_an_error_at_first_is_the_users(monkeypatch: pytest.MonkeyPatch) -> None:
    desk = Desk(monkeypatch)
    desk.door.errors["open"] = OSError("port taken")
    with pytest.raises(OSError, match="port taken"):
        desk.keeper.open()
    assert not desk.keeper.is_open and not desk.said


@pytest.mark.parametrize(("error", "words", "bugs"), [
    (OSError("gone\nnow"), "gone now", 0), (ValueError("bad"), "bad", 0), (can.CanError("off"), "off", 0),
    (OSError(), "OSError", 0),
    (KeyError("k"), "internal error, please report it: KeyError: 'k'", 1),
])  # fmt: skip
def test_a_door_that_breaks_is_closed_and_told(error: Exception, words: str, bugs: int, desk: Desk) -> None:
    assert desk.keeper.is_open and desk.poll(100.0) == [("poll", 7)]
    assert desk.poll(100.0, poll=error) == [("poll", 7), ("close",)]
    assert desk.said == [f"--x: broken: {words}; the others go on, it is tried again every second"]
    assert not desk.keeper.is_open and desk.keeper.bugs == bugs


def test_a_second_later_it_is_tried_again(desk: Desk) -> None:
    """The same reason is told once, another one again."""
    desk.poll(100.0, poll=OSError("gone"), open=OSError("gone"))
    desk.said.clear()
    assert desk.poll(100.9) == []
    assert desk.poll(101.0) == [("open",), ("close",)] and desk.said == []
    assert desk.poll(101.9) == []
    assert desk.poll(102.0, open=OSError("taken")) == [("open",), ("close",)]
    assert desk.poll(103.0) == [("open",), ("close",)]
    assert desk.said == ["--x: still closed: taken"] and not desk.keeper.is_open
    assert desk.poll(104.0, open=None, poll=None) == [("open",)]
    assert desk.said[1:] == ["--x: open again"] and desk.keeper.is_open
    desk.said.clear()
    desk.poll(105.0, poll=OSError("x"), open=OSError("taken"))
    desk.poll(106.0)
    assert desk.said[1:] == ["--x: still closed: taken"]  # it was open in between


def test_one_that_was_never_open_is_tried_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    assert Desk(monkeypatch).poll(0.0) == [("open",)]


def test_closing_is_told_where_it_fails(desk: Desk) -> None:
    desk.keeper.close()
    assert desk.said == [] and not desk.keeper.is_open
    desk.door.errors["close"] = OSError("stuck")
    desk.keeper.close()
    assert desk.said == ["--x: closing: stuck"]
