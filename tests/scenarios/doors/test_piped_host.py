"""The host's end of the pipe over stubs: slices, wishes, and its end."""

from threading import Lock
from types import SimpleNamespace
from typing import Any

import pytest

from host.console.views import BusState
from scenarios.doors import piped_host
from scenarios.doors.pipe_messages import Slice, Taken
from scenarios.doors.piped_host import BusMirror, PipedHost, main


class Pipe:
    """says: what comes; a number stands for looks at which nothing has."""

    def __init__(self, *says: Any) -> None:
        self.says = list(says)
        self.heard: list[Any] = []
        self.broken = False

    def poll(self, timeout_s: float) -> bool:
        assert timeout_s == 0.02
        if self.says and self.says[0] is None:
            self.says.pop(0)
            return False
        return True

    def recv(self) -> Any:
        if not self.says:
            raise EOFError
        return self.says.pop(0)

    def send(self, message: Any) -> None:
        if self.broken:
            raise ConnectionResetError
        self.heard.append(message)

    def __enter__(self) -> "Pipe":
        return self

    def __exit__(self, *_: object) -> None:
        self.broken = True


class Desk:
    """A host without anything on it."""

    def __init__(self, *says: Any) -> None:
        self.pipe, self.calls = Pipe(*says), list[tuple[Any, ...]]()
        made: Any = object.__new__(PipedHost)
        self.camera = SimpleNamespace(looking=False, take=lambda look: self.calls.append(("look", look)))
        made._pipe, made._now_ns = self.pipe, 0
        made._sending = Lock()
        self.errors = SimpleNamespace(errors=0)
        made.pc = SimpleNamespace(
            link=SimpleNamespace(receive=lambda *each: self.calls.append(("report", *each))),
            cameras=(self.camera,), poll=lambda t_ns: self.calls.append(("tick", t_ns)), journal=self.errors,
            telescope=SimpleNamespace(snapshot=SimpleNamespace(activity="tracks")),
        )  # fmt: skip
        made._mirror = BusMirror([], [], self.pipe.send)
        made.runs = SimpleNamespace(recording=True, receive=lambda *each: self.calls.append(("line", *each)))
        made.keepers = [SimpleNamespace(door=SimpleNamespace(name="--lx200 1", state=lambda: "busy"))]
        made.poll = lambda now_ns: self.calls.append(("doors", now_ns))
        made.close = lambda: self.calls.append(("close",))
        self.made = made


TOLD = [("the host", "tracks"), ("--lx200 1", "busy")]


def test_a_slice_is_handed_on_and_answered() -> None:
    bus: Any = BusState([], 0.5, {}, [], [])
    look: Any = "look"
    desk = Desk(
        Slice(8, [(3, b"r")], [("A", b"l")], bus, [look]), Slice(9, [], [], None, []), None, ("close",)
    )
    desk.camera.looking = True
    desk.made.run()
    answer = Taken(False, True, True, TOLD)
    assert desk.pipe.heard == [("opened", TOLD, ""), answer, answer, Taken(False, False, False, TOLD)]
    first = [
        ("report", 3, b"r"),
        ("line", 8, "A", b"l"),
        ("look", "look"),
        ("tick", 8),
        ("tick", 8),
        ("doors", 8),
    ]
    assert desk.calls == [
        *first,
        ("tick", 9),
        ("tick", 9),
        ("doors", 9),
        ("tick", 9),
        ("doors", 9),
        ("close",),
    ]
    assert desk.made._mirror.state.load == 0.5


def test_errors_are_counted_in_its_state_and_a_wish_is_answered() -> None:
    desk = Desk(("done", 0, "yes", False), ("close",))
    desk.errors.errors = 3
    wish = desk.made._mirror.wish("x")
    desk.made.run()
    assert desk.pipe.heard[1] == ("opened", [("the host", "tracks, 3 errors"), TOLD[1]], "")
    assert wish.result(0) == "yes"


def test_an_emulator_that_has_gone_ends_it_without_a_word() -> None:
    desk = Desk()
    desk.made.run()
    assert desk.calls == [("close",)] and len(desk.pipe.heard) == 1
    desk.pipe.broken = True
    desk.made._report(0, b"r")  # nobody hears it


class Side:
    """A host that opens, or not."""

    error: str = ""

    def __init__(self, pipe: Pipe, settings: Any) -> None:
        self.calls: list[str] = []
        if settings == "bad":
            raise ValueError("no catalogue")
        sides.append(self)

    def open(self) -> None:
        if self.error:
            raise OSError(self.error)

    def run(self) -> None:
        self.calls.append("run")

    def close(self) -> None:
        self.calls.append("close")


sides: list[Side] = []


@pytest.mark.parametrize(
    ("settings", "error", "calls", "heard"),
    [("fine", "", ["run"], []), ("fine", "taken", ["close"], [("opened", [], "taken")]),
     ("bad", "", None, [("opened", [], "no catalogue")]), (None, "", None, [])],
)  # fmt: skip
def test_the_process_says_why_it_did_not_open(
    settings: str | None,
    error: str,
    calls: list[str] | None,
    heard: list[Any],
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    sides.clear()
    pipe = Pipe(*([] if settings is None else [settings]))
    numbers: list[int] = []

    def connection(number: int) -> Pipe:
        numbers.append(number)
        return pipe

    monkeypatch.setattr(piped_host, "Connection", connection)
    monkeypatch.setattr(piped_host, "PipedHost", Side)
    monkeypatch.setattr(Side, "error", error)
    main(5)
    assert numbers == [5] and pipe.heard == heard
    assert [each.calls for each in sides] == ([] if calls is None else [calls])
