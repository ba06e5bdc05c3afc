"""The night log word by word: what is the case, what is over, and what was not done."""

from types import SimpleNamespace as Some
from typing import Any

import pytest

from bus.protocol import Device, Focus, FocusFlag
from bus.protocol.nodes import DOME, WEATHER
from host.logs.journal import Journal
from host.telescope.alarms import KEPT, Alarm, Events, Severity, of_telescope

SHUT = {"Opened": 0.0, "Closed": 1.0, "ShutterMoving": 0.0}


class House:
    """Dome and weather as a test wants them."""

    def __init__(self) -> None:
        self.dome: dict[str, float] | None = None
        self.stations: list[str] = []
        self.causes: list[str] = []
        self.slaved = False

    def boards(self, kind: Any) -> list[str]:
        return ["DOME"] if kind is DOME and self.dome is not None else []

    def reading(self, board: str) -> dict[str, float] | None:
        return self.dome if board == "DOME" else None

    def expected(self, kind: Any) -> list[str]:
        return self.stations if kind is WEATHER else []

    def unsafe(self) -> list[str]:
        return self.causes


def telescope(**fields: Any) -> Any:
    usual = {
        "t_s": 1.0, "powered": False, "locked": False, "focus": None, "parked": False, "activity": "idle",
        "target": "",
    }  # fmt: skip
    return Some(snapshot=Some(**usual | fields), house=House(), journal=Journal(None))


def test_a_bare_telescope_says_three_things() -> None:
    assert of_telescope(telescope()) == {"motors": "Motors off", "axes": "Idle", "lock": "Consoles unlocked"}
    found = of_telescope(telescope(powered=True, locked=True, parked=True))
    assert found == {"motors": "Motors on", "axes": "Parked", "lock": "Consoles locked"}


@pytest.mark.parametrize(("activity", "target", "words"), [
    ("slewing", "Vega", "Slewing Vega"), ("tracking", "Vega", "Tracking Vega"),
    ("tracking", "here", "Tracking"),
    ("slewing", "", "Slewing"), ("stopping", "Vega", "Stopping"), ("moved by hand", "Vega", "Moved by hand"),
])  # fmt: skip
def test_axes_are_told_with_their_target(activity: str, target: str, words: str) -> None:
    assert of_telescope(telescope(activity=activity, target=target))["axes"] == words


@pytest.mark.parametrize(("flags", "words"), [
    (FocusFlag.MOVING, "Focus moves"), (FocusFlag.HOLD, "Focus at -12 half steps"),
    (FocusFlag.MOVING | FocusFlag.HOLD, "Focus moves"),
])  # fmt: skip
def test_the_focus_is_told(flags: FocusFlag, words: str) -> None:
    assert of_telescope(telescope(focus=Focus(Device.FOCUS, int(flags), -12, 0, 0)))["focus"] == words


@pytest.mark.parametrize(("fields", "words"), [
    ({}, "Shutter closed"), ({"Closed": 0.0}, "Shutter between its ends"),
    ({"Closed": 0.0, "Opened": 1.0}, "Shutter open"), ({"ShutterMoving": 1.0}, "Shutter moves"),
])  # fmt: skip
def test_the_dome_is_told(fields: dict[str, float], words: str) -> None:
    made = telescope()
    assert "shutter" not in of_telescope(made)
    made.house.dome = SHUT | fields
    found = of_telescope(made)
    assert (found["shutter"], found["slaved"]) == (words, "Dome stays where it is")
    made.house.slaved = True
    assert of_telescope(made)["slaved"] == "Dome follows the telescope"


def test_the_weather_is_told_where_there_is_a_station() -> None:
    made = telescope()
    made.house.causes = ["MAST: rain", "MAST: wind"]
    assert "weather" not in of_telescope(made)
    made.house.stations = ["WEATHER_MAST"]
    assert of_telescope(made)["weather"] == "Weather unsafe: MAST: rain; MAST: wind"
    made.house.causes = []
    assert of_telescope(made)["weather"] == "Weather safe"


def test_a_night_is_what_changes() -> None:
    made, events = telescope(), Events()
    events.take(made, ())
    assert list(events.kept) == [(1.0, "Motors off"), (1.0, "Idle"), (1.0, "Consoles unlocked")]
    events.kept.clear()
    events.take(made, ())
    assert not events.kept, "nothing is new"
    made.snapshot.t_s, made.snapshot.powered = 2.0, True
    rain, gone = Alarm("rain", Severity.ALARM, 2.0), Alarm("noise", Severity.WARNING, 1.0, 1.5)
    events.take(made, (rain, gone))
    assert list(events.kept) == [(2.0, "Motors on"), (2.0, "ALARM: rain")]
    events.kept.clear()
    made.snapshot.t_s = 3.0
    events.take(made, (gone,))
    assert list(events.kept) == [(3.0, "Over: rain")]


def test_what_was_not_done_is_told_once_where_it_is_the_hosts() -> None:
    made, events = telescope(), Events()
    made.journal.error(500_000_000, "HOST", "slew: too low")
    made.journal.error(600_000_000, "AXIS_RA", "TRACK_RATE: no answer")
    made.journal.status(700_000_000, "HOST", "tracks")
    events.take(made, ())
    made.journal.error(800_000_000, "LX200", "unknown")
    made.journal.error(900_000_000, "FOCUS", "free")
    events.take(made, ())
    events.take(made, ())
    told = [each for each in events.kept if each[1].startswith("Not done")]
    assert told == [
        (0.5, "Not done: slew: too low"), (pytest.approx(0.8), "Not done: unknown"),
        (pytest.approx(0.9), "Not done: free"),
    ]  # fmt: skip
    assert events.kept.maxlen == KEPT == 300
