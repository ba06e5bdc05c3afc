"""An order for a snapshot of a run: what is heard and kept on the way, and what goes into the file."""

from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.lab.snapshot import run as runs
from scenarios.lab.snapshot.code import nothing
from scenarios.lab.snapshot.freeze import SnapshotError
from scenarios.lab.snapshot.run import SEEN, Order, Progress, begun, resume


class Desk:
    """A session of stand-ins; heard: what came to its listeners."""

    def __init__(self, folder: Path, gateway: bool = True, chained: bool = True) -> None:
        self.heard: list[tuple[Any, ...]] = []
        self.made: Any = SimpleNamespace(
            link=SimpleNamespace(receive=self.hear("link"), _send=None),
            recorder=SimpleNamespace(take_truth=self.hear("truth kept"), folder=folder, can=SimpleNamespace(
                flush=self.hear("flushed"), resume=self.hear("can resumed"))),
            chain_says=self.hear("chain said"), work=self.hear("work"), rows=["row"], faults="faults",
            serial=[SimpleNamespace(device=SimpleNamespace(name="FOCUS"), receive=self.hear("line"))],
            plant=SimpleNamespace(_sink=None, model="model"), ticked=None, scenario="scenario",
            eye=SimpleNamespace(told=None, replay=lambda each: self.heard.append(("replay", list(each)))),
            flush_traces=self.hear("traces"), begin_traces=self.hear("rows begun"),
            adopt=self.hear("adopted"),
            network=SimpleNamespace(
                boards={"GATEWAY": 0} if gateway else {}, queue=SimpleNamespace(now_ns=7),
                hid=SimpleNamespace(),
                uarts={"FOCUS": SimpleNamespace(sink=None)},
                chain=SimpleNamespace(told=None) if chained else None,
            ),
        )  # fmt: skip
        (folder / "can.log").write_bytes(b"frames")

    def hear(self, who: str) -> Any:
        return lambda *given: self.heard.append((who, *given))


@pytest.fixture
def desk(tmp_path: Path) -> Desk:
    return Desk(tmp_path)


def test_what_comes_out_of_a_network_is_kept_and_goes_on(desk: Desk, tmp_path: Path) -> None:
    order, made = Order(7, tmp_path / "kept"), desk.made
    order.begin(made)
    made.network.hid.to_host(1, b"r")
    made.plant._sink("ra", "rows")
    made.network.uarts["FOCUS"].sink(2, b"l")
    made.network.chain.told(3, "pressed")
    made.ticked(4)
    made.eye.told(0.5, 0.25)
    assert desk.heard == [
        ("link", 1, b"r"), ("truth kept", "ra", "rows"), ("line", 2, b"l"), ("chain said", 3, "pressed"),
    ]  # fmt: skip
    assert order.heard == [
        ("usb", (1, b"r")), ("truth", ("ra", "rows")), ("FOCUS", (2, b"l")), ("chain", (3, "pressed")),
        ("tick", (4,)), (SEEN, (0.5, 0.25)),
    ]  # fmt: skip
    assert made.rows == ["row"]


def test_a_run_that_goes_on_has_heard_before(desk: Desk, tmp_path: Path) -> None:
    order = Order(7, tmp_path / "kept")
    order.begin(desk.made, {"heard": [("usb", ())], "rows": ["before"]})
    desk.made.ticked(4)
    assert order.heard == [("usb", ()), ("tick", (4,))] and desk.made.rows == ["before"]


def test_a_network_may_have_no_safety_chain(tmp_path: Path) -> None:
    Order(7, tmp_path / "kept").begin(Desk(tmp_path, chained=False).made)


def test_what_cannot_be_taken_is_said_at_once(desk: Desk, tmp_path: Path) -> None:
    with pytest.raises(SnapshotError, match=r"^snapshots of a run need a network with a gateway$"):
        Order(7, tmp_path / "kept").begin(Desk(tmp_path, gateway=False).made)
    desk.made.network.queue.now_ns = 2_500_000_000
    with pytest.raises(SnapshotError, match=r"^a snapshot at 1\.5 s: the run is at 2\.5 s already$"):
        Order(1_500_000_000, tmp_path / "kept").begin(desk.made)
    with pytest.raises(ValueError, match="it is no regular file"):
        Order(2_500_000_000, tmp_path).begin(desk.made)


def test_it_is_due_once_and_at_its_very_time(tmp_path: Path) -> None:
    order = Order(10, tmp_path / "kept")
    assert [order.due(until_ns) for until_ns in (9, 10, 11)] == [False, True, True]
    order.done = True
    assert not order.due(11)


def test_a_whole_run_is_written(desk: Desk, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    written: list[Any] = []
    monkeypatch.setattr(runs, "write", lambda *given: written.append(given))
    monkeypatch.setattr(runs, "take", lambda inner, outside: (inner, sorted(outside)))
    order, progress = Order(7, tmp_path / "kept"), Progress(7, 3, 9)
    order.begin(desk.made)
    order.take(desk.made, progress)
    assert order.done and desk.heard == [("traces",), ("flushed",)]
    ((whole, file),) = written
    names = sorted(["usb", "truth", "chain", "FOCUS", "session", "can", "recorder"])
    assert file == tmp_path / "kept" and whole == {
        "scenario": "scenario", "model": "model", "progress": progress, "heard": [], "can": b"frames",
        "rows": ["row"], "network": ((desk.made.network, "faults"), names),
    }  # fmt: skip


@pytest.mark.parametrize("kind", ["served", None])
def test_a_served_session_is_no_run(kind: str | None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(runs, "read", lambda file: {"kind": kind})
    if kind is None:
        assert begun(Path("x")) == {"kind": None}
    else:
        with pytest.raises(SnapshotError, match=r"^x: a served session has no programme to go on with"):
            begun(Path("x"))


def test_a_host_lives_again_by_hearing_the_same(desk: Desk, monkeypatch: pytest.MonkeyPatch) -> None:
    """What it says meanwhile has been said; the picture that the eye saw comes first."""
    monkeypatch.setattr(runs, "Session", lambda *given: desk.made)
    restored: list[Any] = []

    def restore(data: str, outside: Any) -> tuple[str, str]:
        restored.extend((data, sorted(outside)))
        return "network again", "faults again"

    monkeypatch.setattr(runs, "restore", restore)
    heard = [("usb", (1, b"r")), ("tick", (2,)), (SEEN, (0.5, 0.25)), ("FOCUS", (3, b"l"))]
    whole = {
        "scenario": "s", "model": "m", "heard": heard, "rows": ["row"], "can": b"frames", "network": "frozen",
    }  # fmt: skip
    found: Any = resume(whole, Path("there"))
    assert found is desk.made and found.link._send is nothing and found.faults == "faults again"
    assert desk.heard == [
        ("replay", [(0.5, 0.25)]), ("link", 1, b"r"), ("work", 2), ("line", 3, b"l"),
        ("rows begun", ["row"]), ("can resumed", b"frames"), ("adopted", "network again"),
    ]  # fmt: skip
    assert restored == ["frozen", sorted(["usb", "truth", "chain", "FOCUS", "session", "can", "recorder"])]
