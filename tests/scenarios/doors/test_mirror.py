"""The bus as the host's pages see it, their wishes, and the cameras of an Alpaca door."""

from concurrent.futures import Future
from types import SimpleNamespace
from typing import Any

import pytest

from host.camera.models import CAMERAS
from host.console.views import BusState
from scenarios.doors import piped_host
from scenarios.doors.piped_host import BusMirror, cameras


def mirror(sent: list[object]) -> BusMirror:
    return BusMirror(["A"], [], sent.append)


def test_somebody_looks_for_a_second_after_a_look(monkeypatch: pytest.MonkeyPatch) -> None:
    clock = [0.5]
    monkeypatch.setattr(piped_host, "monotonic", lambda: clock[0])
    seen = mirror([])
    assert not seen.watching and seen.boards == ("A",)
    assert seen.look() == BusState([], 0.0, {}, [], []) and seen.watching
    clock[0] = 1.49
    assert seen.watching
    clock[0] = 1.5
    assert not seen.watching


def test_wishes_have_numbers_and_are_granted_or_refused_once() -> None:
    sent: list[object] = []
    seen = mirror(sent)
    one, other, gone = (seen.wish(f"power {k}") for k in range(3))
    assert sent == [("wish", k, f"power {k}") for k in range(3)]
    gone.cancel()
    seen.done(1, "no", True)
    seen.done(0, "yes", False)
    for number in (0, 2, 7):
        seen.done(number, "again", False)
    assert one.result(0) == "yes" and isinstance(other.exception(0), ValueError)
    assert str(other.exception(0)) == "no" and isinstance(gone, Future)


def options(**more: Any) -> Any:
    return SimpleNamespace(**({"asked": {"alpaca": ["1"]}, "stars": None, "frames": None} | more))


def test_cameras_are_there_with_an_alpaca_door_alone(monkeypatch: pytest.MonkeyPatch) -> None:
    made: list[tuple[Any, ...]] = []

    def make(*each: Any) -> Any:
        made.append(each)
        return each

    monkeypatch.setattr(piped_host, "Camera", make)
    monkeypatch.setattr(piped_host, "SyntheticSky", lambda: "a sky")
    monkeypatch.setattr(piped_host, "from_file", lambda file: f"stars of {file}")
    scenario: Any = SimpleNamespace(site="site", clock="clock", seed=4)
    seen: list[object] = []
    guiding: Any = SimpleNamespace(frame=seen.append)
    assert cameras(scenario, options(asked={}), None) == ()
    found: Any = cameras(scenario, options(), guiding)
    assert len(found) == len(CAMERAS) and found[0][1:5] == ("a sky", "site", "clock", 4)
    found[0][5]("frame")
    assert seen == ["frame"]
    bare: Any = cameras(scenario, options(stars="file"), None)
    bare[0][5]("frame")
    assert bare[0][1] == "stars of file" and seen == ["frame"]
