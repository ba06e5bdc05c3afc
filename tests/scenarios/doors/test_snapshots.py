"""`schmidt serve --snapshots`: names, time that stands meanwhile, and what is told."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from host.logs.files import LogError
from scenarios.doors import snapshots
from scenarios.doors.snapshots import Snapshots, standing
from scenarios.lab.snapshot.code import nothing
from scenarios.lab.snapshot.freeze import SnapshotError
from tests.scenarios.doors.served import stub


class Desk:
    """Snapshots of a network that is a stand-in."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        self.paused: list[bool] = []
        self.marks: list[Any] = []
        self.error: Exception | None = None
        pacer = SimpleNamespace(paused=False)
        self.served = stub(
            now_ns=1_500_000_000, pacer=pacer, entry=SimpleNamespace(count=4), snapshot=None, network="n",
            faults="f", usb="u", nodes="o", scenario="s", model="m",
        )  # fmt: skip
        monkeypatch.setattr(snapshots, "write", self.write)
        monkeypatch.setattr(snapshots, "take", lambda inner, outsiders: (inner, outsiders))
        self.folder = folder / "a" / "b"
        recording: Any = SimpleNamespace(mark=lambda *given: self.marks.append(given))
        self.kept = Snapshots(self.folder, self.served, recording)

    def write(self, whole: dict[str, Any], file: Path) -> int:
        self.paused.append(self.served.pacer.paused)
        if self.error is not None:
            raise self.error
        self.whole = whole
        file.write_text("x")
        return 1000


@pytest.fixture
def desk(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(tmp_path, monkeypatch)


@pytest.mark.parametrize(("asked", "name"), [("night-1", "night-1"), ("", "1.500000s"), ("a" * 64, "a" * 64)])
@pytest.mark.parametrize("paused", [False, True])
def test_time_stands_while_one_is_taken(asked: str, name: str, paused: bool, desk: Desk) -> None:
    desk.served.pacer.paused = paused
    told = desk.served.snapshot(asked)
    assert told == f"{desk.folder / name}: 1.500000 s, 4 entries, 1000 bytes"
    assert desk.paused == [True] and desk.served.pacer.paused is paused
    assert desk.marks == [(name, desk.served)]
    assert desk.whole == {
        "kind": "served", "scenario": "s", "model": "m", "entries": 4,
        "network": (("n", "f", "u", "o"), snapshots._OUTSIDERS),
    }  # fmt: skip


def test_a_disk_that_is_full_leaves_the_pace_as_it_was(desk: Desk) -> None:
    desk.error = LogError("no space")
    with pytest.raises(LogError):
        desk.kept.take("x")
    assert desk.served.pacer.paused is False and not desk.marks


@pytest.mark.parametrize("name", ["a" * 65, "../x", ".x", "a b", "-x"])
def test_a_name_that_is_none_is_refused(name: str, desk: Desk) -> None:
    with pytest.raises(SnapshotError, match="letters, digits, dots and dashes, 64 at most"):
        desk.kept.take(name)
    assert not desk.paused


def test_no_snapshot_is_written_over(desk: Desk) -> None:
    desk.kept.take("x")
    with pytest.raises(SnapshotError, match="there is a snapshot x; take another name"):
        desk.kept.take("x")
    assert len(desk.paused) == 1


def test_a_folder_may_be_there_but_no_file(desk: Desk, tmp_path: Path) -> None:
    Snapshots(desk.folder, desk.served).take("unrecorded")
    assert not desk.marks
    (tmp_path / "file").touch()
    with pytest.raises(LogError, match="file: cannot be made: "):
        Snapshots(tmp_path / "file", desk.served)


@pytest.mark.parametrize("kind", ["served", "run"])
def test_nobody_listens_to_a_network_that_stood(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    def uart() -> Any:
        return SimpleNamespace(sink=1, line=1)

    recorded: list[Any] = []
    ours = object()
    port = SimpleNamespace(on_receive=1, on_error=1)
    debug, line = SimpleNamespace(sink=1), uart()
    network = SimpleNamespace(
        wire=SimpleNamespace(_taps=[ours, nothing]), plant=SimpleNamespace(record=recorded.append),
        hid=SimpleNamespace(to_host=1), uarts={"FOCUS": line}, debug={"FOCUS": debug},
    )  # fmt: skip
    node = SimpleNamespace(port=port)
    more = ["usb", {"can0": node}] if kind == "served" else []
    monkeypatch.setattr(snapshots, "restore", lambda frozen, names: (network, "faults", *more))
    found = standing({"kind": kind, "network": "frozen", "scenario": "s", "model": "m"})
    assert network.wire._taps == [ours] and recorded == [None] and network.hid.to_host is None
    assert (line.sink, line.line, debug.sink) == (None, None, None)
    if kind == "served":
        assert found.usb == "usb" and found.nodes == {"can0": node}  # type: ignore[comparison-overlap]
        assert (port.on_receive, port.on_error) == (None, None)
    else:
        assert found.usb is None and found.nodes == {}
    assert found.entries == 0 and found.faults == "faults"  # type: ignore[comparison-overlap]
