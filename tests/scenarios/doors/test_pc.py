"""The host program of a scenario: when it ticks, logs and ends; and what its doors are kept by."""

import datetime as dt
from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from host.client import TICK_NS
from host.sky.observed import Clock
from scenarios.doors import pc
from scenarios.doors.options import DoorOptions
from scenarios.doors.pc import Host, ServerDoor, TelescopePc, dated
from scenarios.lab.networks import devices_in
from scenarios.lab.prepare import UNDATED, chosen


def made(logs: Path | None = None) -> Any:
    """The host program of the lab's network."""
    scenario = replace(chosen()[0], status_period_s=4.0)
    return TelescopePc(scenario, lambda t_ns, data: None, devices_in(scenario), logs)


class Desk:
    """A host program whose telescope is a stand-in; heard: what was asked of whom."""

    def __init__(self, logs: Path | None = None) -> None:
        self.heard: list[Any] = []
        self.pc = made(logs)
        self.pc.telescope.close()
        self.pc.telescope = SimpleNamespace(
            tick=self.hear("tick"), urgent=False, client="client", close=self.hear("close")
        )
        if logs is not None:
            self.pc.files.close()
            self.pc.files = SimpleNamespace(flush=self.hear("flush"), close=self.hear("files closed"))
            self.pc.guiding = SimpleNamespace(tick=self.hear("guiding"), write=self.hear("guiding written"))
            self.pc.journal = SimpleNamespace(sensors=self.hear("sensors"))

    def hear(self, who: str) -> Any:
        return lambda *given: self.heard.append((who, *given))


def test_a_scenario_without_a_date_has_todays_sky(monkeypatch: pytest.MonkeyPatch) -> None:
    now = dt.datetime(2026, 3, 1, 12, 0, 5, 123, tzinfo=dt.UTC)
    today = SimpleNamespace(datetime=SimpleNamespace(now={dt.UTC: now}.__getitem__), UTC=dt.UTC)
    monkeypatch.setattr(pc, "dt", today)
    scenario, _ = chosen()
    assert scenario.clock is UNDATED
    assert dated(scenario).clock.start_utc == now.replace(microsecond=0)
    stated = Clock(dt.datetime(2026, 2, 10, tzinfo=dt.UTC))
    assert dated(replace(scenario, clock=stated)).clock is stated


def test_the_declination_motors_get_their_bias_in_256ths(monkeypatch: pytest.MonkeyPatch) -> None:
    """Q8: eight bits behind the point."""
    monkeypatch.setattr(pc, "bias_steps", lambda model, motor: 3 if motor is model.axes.dec.motor else 0)
    found = made()
    assert found.telescope.drive.dec_bias_q8 == 3 * 256
    assert found.files is None and found.guiding is None and found.cameras == ()
    assert found.lx200 is found.lx200  # its doors share one handbox


def test_logs_are_made_where_they_are_asked_for(tmp_path: Path) -> None:
    folder = tmp_path / "a" / "b"
    for _ in range(2):  # also where they are
        made(folder).close()
    assert {file.name for file in folder.iterdir()} >= {"status.log", "commands.log", "sensors.log"}


def test_it_ticks_once_a_period_and_at_once_for_an_emergency() -> None:
    """A period that was missed is not made up for."""
    desk = Desk()
    for t_ns in (0, TICK_NS - 1, TICK_NS, 10 * TICK_NS, 10 * TICK_NS, 10 * TICK_NS + 1):
        desk.pc.poll(t_ns)
    assert [t_ns for _, t_ns in desk.heard] == [0, TICK_NS, 10 * TICK_NS, 10 * TICK_NS + 1]
    desk.pc.telescope.urgent = True
    desk.pc.poll(10 * TICK_NS + 2)
    assert desk.heard[-1] == ("tick", 10 * TICK_NS + 2)


def test_logs_have_a_period_of_their_own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pc, "readings", lambda client, mount: f"{client} read")
    desk, period_ns = Desk(tmp_path), 4_000_000_000
    desk.pc.poll(0)
    assert desk.heard == [("tick", 0), ("guiding",), ("sensors", 0, "client read"), ("flush",)]
    desk.heard.clear()
    for t_ns in (period_ns - 1, period_ns + TICK_NS):
        desk.pc.poll(t_ns)
    assert [each for each in desk.heard if each[0] == "sensors"] == [
        ("sensors", period_ns + TICK_NS, "client read")
    ]
    desk.heard.clear()
    desk.pc.poll(2 * period_ns + TICK_NS)  # a period after the last one
    assert ("flush",) in desk.heard


def test_a_log_is_due_at_its_very_time(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pc, "readings", lambda client, mount: "")
    desk = Desk(tmp_path)
    desk.pc.poll(0)
    desk.heard.clear()
    desk.pc.poll(4_000_000_000)
    assert ("flush",) in desk.heard


def test_its_end_is_told_and_written(tmp_path: Path) -> None:
    desk = Desk(tmp_path)
    desk.pc.close()
    assert desk.heard == [("close",), ("guiding written",), ("files closed",)]


def test_doors_are_opened_polled_and_closed_before_what_they_stand_on() -> None:
    desk = Desk()
    nothing: Any = None
    host = Host(desk.pc, nothing, nothing, DoorOptions(), print)
    assert host.keepers == []
    for name in ("one", "two"):
        calls = {word: desk.hear(f"{name} {word}") for word in ("open", "poll", "close")}
        keeper: Any = SimpleNamespace(**calls)
        host.keepers.append(keeper)
    host.outside.close()
    stub: Any = SimpleNamespace(close=desk.hear("outside"))
    host.outside = stub
    host.open()
    host.poll(5)
    host.close()
    assert desk.heard == [
        ("one open",), ("two open",), ("one poll", 5), ("two poll", 5), ("one close",), ("two close",),
        ("outside",), ("close",),
    ]  # fmt: skip


def test_servers_of_a_door_are_looked_at_until_it_closes() -> None:
    heard: list[str] = []
    service = SimpleNamespace(check=lambda: heard.append("check"), cancel=lambda: heard.append("cancel"))
    host: Any = SimpleNamespace(outside=SimpleNamespace(keep=lambda work: service))
    door = ServerDoor("--x", host)
    work: Any = "work"
    door.keep(work)
    door.poll(0)
    door.close()
    door.poll(0)
    door.close()
    assert heard == ["check", "cancel"] and door.name == "--x"
