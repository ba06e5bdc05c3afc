"""Files of a run while it runs: which there are, what closes them, and what the digest is of."""

import hashlib
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bus.can import Frame
from bus.protocol import Device
from host.logs import distort
from host.logs.files import LogError
from plant.grid import TRUTH_COLUMNS
from scenarios.lab import recorder
from scenarios.lab.prepare import chosen
from scenarios.lab.recorder import Recorder, _distortions

HEADERS = {
    axis: {"axis": axis, "session": "x", "loop": "open", "start_utc": "2026-02-10T14:00:00Z"}
    for axis in ("ra", "dec")
}


class StandIn:
    """A plant that only says who records it."""

    def __init__(self) -> None:
        self.recorded: list[Any] = []

    def record(self, sink: Any, period_ns: int | None = None) -> None:
        self.recorded.append((sink, period_ns))

    def log_effects(self, axis: str) -> list[Any]:
        return []


def made(folder: Path, can_log: str = "text", plant: Any = None) -> Any:
    scenario = SimpleNamespace(
        clock=chosen()[0].clock, seed=3, can_log=can_log, trace_period_s=2.0
    )  # fmt: skip
    given: Any = scenario
    stand_in: Any = StandIn()
    return Recorder(folder, given, plant or stand_in, HEADERS)


def test_files_are_there_at_once_and_truth_is_asked_for(tmp_path: Path) -> None:
    plant = StandIn()
    found = made(tmp_path, plant=plant)
    assert plant.recorded == [(found.take_truth, 2_000_000_000)]
    assert found.close() == [] and plant.recorded[1:] == [(None, None)]
    names = {file.name for file in tmp_path.iterdir()}
    assert {"can.log", "axis-ra.csv", "axis-dec.csv", "status.log", "commands.log", "sensors.log"} <= names
    assert "can.log.zst" not in names


@pytest.mark.parametrize(("can_log", "name", "other"), [
    ("text", "can.log", "can.log.zst"), ("zstd", "can.log.zst", "can.log"), ("mf4", "can.log", "can.log.zst"),
])  # fmt: skip
def test_a_bus_log_of_an_earlier_run_goes(can_log: str, name: str, other: str, tmp_path: Path) -> None:
    (tmp_path / other).write_text("old")
    found = made(tmp_path, can_log)
    found.can.take(0, Frame(0x11, b"\x11"))
    found.close()
    assert (tmp_path / name).stat().st_size > 0 and not (tmp_path / other).exists()


def test_a_line_of_an_axis_board_becomes_its_log(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorder, "SerialLink", lambda *given: given)
    found = made(tmp_path)
    for axis, device in (("ra", Device.AXIS_RA), ("dec", Device.AXIS_DEC)):
        assert found.link(device) == (device, found.ascii, found.axis[axis].packet)
    assert found.link(Device.FOCUS)[2](0, b"") is None
    found.close()


def test_flushing_brings_text_to_disk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    looked: list[Path] = []
    monkeypatch.setattr(recorder, "check_space", looked.append)
    found = made(tmp_path)
    found.can.take(0, Frame(0x11, b"\x11"))
    found.ascii.error(0, "X", "said")
    found.axis["ra"].file.write("row\n")
    found.flush()
    assert looked == [tmp_path, tmp_path]
    assert (tmp_path / "can.log").read_text().endswith("011#11\n")
    assert "row" in (tmp_path / "axis-ra.csv").read_text()
    assert any("said" in file.read_text() for file in tmp_path.glob("*.log"))
    found.close()


def test_the_digest_is_of_bus_axis_logs_and_truth(tmp_path: Path) -> None:
    """In this order; truth as it is in memory, whatever its rows are a view of."""
    found = made(tmp_path)
    found.can.take(0, Frame(0x11, b"\x11"))
    wide = np.arange(48.0).reshape(2, 24)
    columns = len(TRUTH_COLUMNS)
    kept: list[int] = []
    found.truth = {axis: SimpleNamespace(append=lambda rows: kept.append(len(rows)), close=lambda: None)
                   for axis in ("ra", "dec")}  # fmt: skip
    for axis, rows in (("ra", wide[:, :columns]), ("dec", wide[:1, :columns])):
        found.take_truth(axis, rows)
    assert kept == [2, 1]
    found.close()
    parts = [hashlib.sha256((tmp_path / name).read_bytes()).hexdigest()
             for name in ("can.log", "axis-ra.csv", "axis-dec.csv")]  # fmt: skip
    parts += [hashlib.sha256(rows.tobytes()).hexdigest() for rows in (wide[:, :columns], wide[:1, :columns])]
    assert found.digest() == hashlib.sha256("\n".join(parts).encode()).hexdigest()


def test_all_is_closed_whatever_fails(tmp_path: Path) -> None:
    found = made(tmp_path)

    def full() -> None:
        raise LogError("can.log: full")

    found.can.close()
    found.can = SimpleNamespace(close=full)
    found.host.close()
    found.host = SimpleNamespace(close=full)
    for log in found.axis.values():
        log.file.write("row\n")
    assert found.close() == ["can.log: full"] * 2
    assert all((tmp_path / f"axis-{axis}.csv").read_text().endswith("row\n") for axis in HEADERS)


def test_another_plant_is_left_at_the_end(tmp_path: Path) -> None:
    first, other = StandIn(), StandIn()
    found = made(tmp_path, plant=first)
    found.adopt(other)
    found.close()
    assert len(first.recorded) == 1 and other.recorded == [(None, None)]


def test_effects_of_a_log_are_drawn_each_for_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """By seed, axis, name and place."""
    drawn: list[str] = []
    monkeypatch.setattr(recorder, "generator", lambda seed, name: drawn.append(f"{seed} {name}"))
    monkeypatch.setattr(distort, "one", lambda random, **given: given, raising=False)
    monkeypatch.setattr(distort, "chain", lambda found: found)
    plant: Any = SimpleNamespace(log_effects=lambda axis: [("one", {"a": 1}), ("one", {"a": 2})])
    found: Any = _distortions(plant, "ra", 3)
    assert found == [{"a": 1}, {"a": 2}] and drawn == ["3 log.ra.one.0", "3 log.ra.one.1"]
