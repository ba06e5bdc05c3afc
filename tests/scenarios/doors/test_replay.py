"""What entered a session, read and entered again in its order; what is refused; over a stub network."""

import json
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from scenarios.doors import replay
from scenarios.doors.recording import ENTERED, SESSION
from tests.scenarios.doors.served import stub_served

S = 1_000_000_000


class Session:
    """A folder with entries; entered: (time, kind, data) of what came in again."""

    def __init__(self, folder: Path, text: str) -> None:
        self.folder = folder
        (folder / ENTERED).write_text(text)
        self.served = stub_served()
        self.entered: list[tuple[int, str, bytes]] = []
        self.served.entry.enter = self.enter

    def enter(self, kind: str, data: bytes) -> None:
        if kind == "bad":
            raise ValueError("not so")
        self.entered.append((self.served.now_ns, kind, data))

    def again(self, after: int = 0, **facts: Any) -> None:
        replay._enter(self.served, self.folder, facts, after)


@pytest.fixture
def session(tmp_path: Path) -> Callable[[str], Session]:
    return lambda text: Session(tmp_path, text)


def test_entries_come_at_their_times_and_time_goes_on_to_the_end(session: Callable[[str], Session]) -> None:
    made = session("5 usb 00ff\n5 can0 \n2500000000 usb 01\n")
    made.again(end_ns=4 * S)
    assert made.entered == [(5, "usb", b"\0\xff"), (5, "can0", b""), (2 * S + S // 2, "usb", b"\1")]
    assert made.served.now_ns == 4 * S


def test_after_a_snapshot_the_first_ones_are_left_out(session: Callable[[str], Session]) -> None:
    made = session("5 usb 00\n6 usb 01\n")
    made.again(after=1, end_ns=10)
    assert made.entered == [(6, "usb", b"\1")] and made.served.now_ns == 10


def test_a_session_that_was_never_closed_ends_with_its_last_entry(session: Callable[[str], Session]) -> None:
    made = session("5 usb 00\n3000000000 usb 01\n")
    made.again()
    assert made.served.now_ns == 3 * S


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("5 usb 00\n4 usb 00\n", "4 usb: is earlier than the time reached"),
        ("11 usb 00\n", "11 usb: is after the session's end"),
        ("5 bad 00\n", "5 bad: not so"),
    ],
)
def test_an_entry_that_cannot_be_is_said(text: str, said: str, session: Callable[[str], Session]) -> None:
    made = session(text)
    with pytest.raises(ValueError) as caught:
        made.again(end_ns=10)
    assert str(caught.value) == f"{made.folder / ENTERED}: {said}"


def test_the_very_end_is_no_later(session: Callable[[str], Session]) -> None:
    made = session("10 usb 00\n")
    made.again(end_ns=10)
    assert made.entered == [(10, "usb", b"\0")]


@pytest.mark.parametrize("line", ["5 usb", "x usb 00", "5 usb 0", "5 usb 00 1", ""])
def test_a_line_that_is_no_entry_is_named(line: str, tmp_path: Path) -> None:
    file = tmp_path / ENTERED
    file.write_text(f"1 usb 00\n{line}\n")
    with pytest.raises(ValueError) as caught:
        list(replay._entries(file))
    assert str(caught.value) == f"{file}:2: not an entry: {line + chr(10)!r}"


def test_a_file_that_is_not_there_is_said(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"entered\.log: "):
        list(replay._entries(tmp_path / ENTERED))


def test_a_second_is_gone_at_a_time(monkeypatch: pytest.MonkeyPatch) -> None:
    served = stub_served()
    shown: list[tuple[float | None, str]] = []
    replay._go(served, 2 * S + 1, 3 * S, lambda done, text: shown.append((done, text)))
    assert shown == [(S, "1 s simulated"), (2 * S, "2 s simulated"), (2 * S + 1, "2 s simulated")]
    shown.clear()
    replay._go(served, 2 * S + 2, 0, lambda done, text: shown.append((done, text)))
    assert shown == [(None, "2 s simulated")]
    replay._go(served, 5, 0, lambda done, text: shown.append((done, text)))
    assert served.now_ns == 2 * S + 2


def test_nodes_of_doors_to_CAN_are_made_once_in_their_order() -> None:
    served = stub_served()
    replay._nodes(served, {"kinds": ["can3", "usb", "can0", "can3", "can123", "xcan1", "can12"]})
    assert served.nodes == [3, 0, 12]


def test_a_session_is_not_replayed_onto_itself(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(replay, "_facts", lambda folder: {})
    with pytest.raises(ValueError, match=r": a session is not replayed onto itself; give another --out$"):
        replay.replay(tmp_path, tmp_path / "x" / "..")


def test_a_folder_without_a_session_is_said(tmp_path: Path) -> None:
    for text in (None, "{", json.dumps({"seed": 1})):
        if text is not None:
            (tmp_path / SESSION).write_text(text)
        with pytest.raises(ValueError, match=rf"^{tmp_path}: no recorded session \({SESSION}\): "):
            replay._facts(tmp_path)


@pytest.mark.parametrize("begun", [True, False])
@pytest.mark.parametrize("own", [True, False])
def test_a_session_is_made_again_of_what_its_folder_has(
    begun: bool, own: bool, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A scenario and a plant, or the snapshot that it went on from."""
    facts = {
        "kinds": ["can2"],
        "scenario": own,
        "seed": 4,
        "network": "lab",
        "begun": begun,
        "digest": "then",
    }
    asked: list[tuple[Any, ...]] = []
    done: list[str] = []
    served = stub_served()
    served.now_ns = 9
    stood = SimpleNamespace(scenario="stood", model="stood")
    recording = SimpleNamespace(attach=lambda _: done.append("attach"), close=lambda t_ns: f"now {t_ns}")

    def network(*each: Any, **more: Any) -> Any:
        asked.append((*each, more["begun"]))
        return served

    def chosen(file: Path | None, seed: int, network_name: str | None) -> tuple[str, None]:
        asked.append((file, seed, network_name))
        return "chosen", None

    monkeypatch.setattr(replay, "_facts", lambda folder: facts)
    monkeypatch.setattr(replay, "standing", lambda found: stood)
    monkeypatch.setattr(replay, "read", lambda file: asked.append((file,)))
    monkeypatch.setattr(replay, "chosen", chosen)
    monkeypatch.setattr(replay, "load_plant", lambda file: file.name)
    monkeypatch.setattr(replay, "Recording", lambda *each: asked.append(each) or recording)  # type: ignore[func-returns-value]
    monkeypatch.setattr(replay, "LiveNetwork", network)
    monkeypatch.setattr(replay, "_enter", lambda *_: done.append("enter"))
    assert replay.replay(tmp_path, tmp_path / "out") == ("now 9", "then")
    assert done == ["attach", "enter"] and served.nodes == [2]
    snapshot = tmp_path / "begun.snapshot"
    if begun:
        expected = [(snapshot,), (tmp_path / "out", snapshot), ("stood", "stood", stood)]
    else:
        file = tmp_path / "scenario.yaml" if own else None
        expected = [(file, 4, "lab"), (tmp_path / "out", None), ("chosen", "plant.yaml", None)]  # type: ignore[list-item]
    assert asked == expected


@pytest.mark.parametrize(("t_ns", "entries", "found"), [(5, 2, "a rest"), (6, 2, None), (5, 3, None)])
def test_the_rest_is_compared_with_that_of_the_same_snapshot(
    t_ns: int, entries: int, found: str | None, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    facts = {"kinds": [], "snapshots": {"a": {"t_ns": 5, "entries": 2, "rest": "a rest"}}}
    served = stub_served()
    served.now_ns = t_ns
    entered: list[int] = []
    monkeypatch.setattr(replay, "_facts", lambda folder: facts)
    monkeypatch.setattr(replay, "read", lambda file: {})
    stood = SimpleNamespace(entries=entries, scenario=None, model=None)
    monkeypatch.setattr(replay, "standing", lambda _: stood)
    monkeypatch.setattr(replay, "LiveNetwork", lambda *_, **__: served)
    monkeypatch.setattr(replay, "Rest", lambda _: SimpleNamespace(digest=lambda: "now"))
    monkeypatch.setattr(replay, "_enter", lambda *each: entered.append(each[3]))
    assert replay.replay_rest(tmp_path, tmp_path / "snapshot") == ("now", found)
    assert entered == [entries]
