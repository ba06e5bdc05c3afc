"""`schmidt conformance`: which boards are checked on which bus, and how far it is."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from bus.conformance import Settings
from bus.conformance.result import told
from bus.protocol import Device
from scenarios.commands import checking

LAB = 11
"""Boards of the lab's network."""


class Desk:
    """The command without a bus: it writes down what would be checked."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.total = 0.0
        self.shows: list[tuple[float | None, str]] = []
        self.boards: list[str] = []
        self.settings = Settings()
        self.spec: tuple[str, Path | None] | None = None
        self.scenario: Any = None
        monkeypatch.setattr(checking, "shown", self.shown)
        monkeypatch.setattr(checking, "wire", self.wire)
        monkeypatch.setattr(checking, "SchmidtBus", self.bus)
        monkeypatch.setattr(checking, "check", self.check)
        monkeypatch.setattr(checking, "conformance_command", self.outside)

    @contextmanager
    def shown(self, _title: str, total: float) -> Iterator[Any]:
        self.total = total
        yield lambda done, text: self.shows.append((done, text))

    @contextmanager
    def bus(self, wire: str) -> Iterator[str]:
        assert wire == "wire"
        yield "bus"

    def wire(self, scenario: Any, _model: object) -> Any:
        self.scenario = scenario
        return SimpleNamespace(wire="wire")

    def check(self, bus: str, file: Path | None, settings: Settings, boards: Any, _dbc: object) -> int:
        assert bus == "bus" and file == Path("found.json")
        self.boards, self.settings = [each.name for each in boards], settings
        return 7

    def outside(self, spec: str, file: Path | None, boards: Any, settings: Settings, _dbc: object) -> int:
        self.spec, self.boards, self.settings = (spec, file), [each.name for each in boards], settings
        return 8


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


FILE = Path("found.json")


def test_the_labs_network_is_checked_in_this_process(desk: Desk) -> None:
    """There time stamps are exact. Listening counts as a board."""
    assert checking.command(None, FILE) == 7
    assert len(desk.boards) == LAB and desk.total == 1 + LAB and Device.AXIS_RA.name in desk.boards
    assert replace(desk.settings, each=Settings().each) == Settings(stamps_s=0.0)
    assert "canopen" not in desk.scenario.network


def test_what_is_asked_for_is_kept(desk: Desk) -> None:
    asked = Settings(speed=2.0, canopen=True, stamps_s=0.5)
    assert checking.command(None, FILE, ["axis:0x11"], asked) == 7
    assert len(desk.boards) == 1 and desk.total == 2
    assert replace(desk.settings, each=asked.each) == replace(asked, stamps_s=0.0)
    assert desk.scenario.network["canopen"] is True


def test_a_bus_outside_keeps_its_stamps(desk: Desk) -> None:
    assert checking.command("socketcan:can0", FILE, (), Settings(stamps_s=0.5)) == 8
    assert desk.spec == ("socketcan:can0", FILE) and desk.settings.stamps_s == 0.5
    assert len(desk.boards) == LAB and desk.scenario is None


def test_progress_is_told_by_boards(desk: Desk) -> None:
    """Frames are listened to first, and their names are single words; a board's commands follow."""
    each = checking._told(["ONE", "TWO"], lambda done, text: desk.shows.append((done, text)))
    for subject in ("ONE_STATUS", "ONE STOP", "TWO STOP", "ONE STOP", "OTHER STOP", "TWO"):
        each(told("reply", subject, ""))
    assert [done for done, _ in desk.shows] == [0, 1, 2, 2, 2, 2]
    assert desk.shows[1][1] == "reply: ONE STOP"
