"""`schmidt.Lab` over a network of stand-ins: spans, replies in time, tables that are empty."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bus.can import Frame
from bus.protocol import COMMAND_BASE, REPLY_BASE, Device, Opcode
from bus.time import EventQueue
from scenarios.lab import lab as labs
from scenarios.lab.fixture import pytest_configure
from scenarios.lab.lab import Lab

MS = 1_000_000
ANSWERS: Any = Frame(REPLY_BASE + Device.FOCUS, b"reply")


class Desk:
    """A lab; its board answers a command after so long."""

    def __init__(self, monkeypatch: pytest.MonkeyPatch) -> None:
        self.queue = EventQueue()
        self.recorded: list[Any] = []
        self.sent: list[Frame] = []
        self.answer_ns: int | None = None
        self.lab = blank()
        plant = SimpleNamespace(record=self.recorded.append, advance=lambda t_ns: None, flush=lambda: None)
        self.lab.plant, self.lab._frames = plant, []
        self.lab._truth = {"ra": [], "dec": []}
        self.lab._node = SimpleNamespace(arrive=self.arrive)
        self.lab.network = SimpleNamespace(
            queue=self.queue, run_until=self.queue.run_until, board=lambda name: SimpleNamespace(name=name)
        )
        monkeypatch.setattr(labs, "unpack_reply", lambda data: data)

    def arrive(self, frame: Frame) -> None:
        self.sent.append(frame)
        if self.answer_ns is not None:
            frames = self.lab._frames
            self.queue.at(self.answer_ns, lambda t_ns: frames.append((t_ns, ANSWERS, "FOCUS")))


def blank() -> Any:
    """A lab that nothing has been made of."""
    return object.__new__(Lab)


@pytest.fixture
def desk(monkeypatch: pytest.MonkeyPatch) -> Desk:
    return Desk(monkeypatch)


@pytest.mark.parametrize(("span", "until_ns"), [
    ("2 s", 2_000 * MS), (2, 2_000 * MS), (0.5, 500 * MS), ("5 ms", 5 * MS)
])  # fmt: skip
def test_a_span_is_seconds_or_says_its_unit(span: Any, until_ns: int, desk: Desk) -> None:
    assert desk.lab.run(span) is desk.lab and desk.queue.now_ns == until_ns
    assert desk.lab.now_s == pytest.approx(until_ns / 1e9)


@pytest.mark.parametrize("answer_ns", [0, 1, 99 * MS, 100 * MS])
def test_a_reply_within_a_tenth_of_a_second_is_one(answer_ns: int, desk: Desk) -> None:
    """Time goes on by milliseconds, and no further than to the reply."""
    desk.answer_ns = answer_ns
    assert desk.lab.ask("FOCUS", "PING") == b"reply"
    assert answer_ns <= desk.queue.now_ns <= answer_ns + MS
    ping = bytes([Device.FOCUS, Opcode.PING]).ljust(8, b"\0")
    assert desk.sent == [Frame(COMMAND_BASE + Device.FOCUS, ping)]


@pytest.mark.parametrize("answer_ns", [None, 101 * MS])
def test_a_reply_that_is_later_is_none(answer_ns: int | None, desk: Desk) -> None:
    desk.answer_ns = answer_ns
    desk.lab._frames.append((0, ANSWERS, "FOCUS"))  # of an earlier command
    with pytest.raises(ValueError, match=r"^FOCUS does not answer PING$"):
        desk.lab.ask("FOCUS", "PING")
    assert desk.queue.now_ns == 100 * MS


def test_frames_are_in_seconds_and_by_sender(desk: Desk) -> None:
    desk.lab._frames.append((1_500 * MS, Frame(0x241, b"\x01\xff"), "FOCUS"))
    desk.lab._frames.append((2_000 * MS, Frame(0x211, b""), "AXIS_RA"))
    found = desk.lab.frames()
    assert found["t_s"].tolist() == pytest.approx([1.5, 2.0]) and found["data"].tolist() == ["01ff", ""]
    assert desk.lab.frames("FOCUS")["identifier"].tolist() == [0x241]
    assert len(desk.lab.frames("NOBODY")) == 0


def test_truth_is_empty_before_there_is_any(desk: Desk) -> None:
    found = desk.lab.truth("ra")
    assert len(found) == 0 and found.dtype.names[0] == "t_s"
    columns = len(found.dtype.names)
    desk.lab._truth["ra"] += [np.ones((2, columns)), np.zeros((1, columns))]
    assert desk.lab.truth("ra")["t_s"].tolist() == [1.0, 1.0, 0.0]


def test_what_ends_records_no_more(desk: Desk) -> None:
    with desk.lab:
        assert desk.recorded == []
    assert desk.recorded == [None]


def test_the_mark_of_the_fixture_is_known() -> None:
    told: list[tuple[str, str]] = []
    config: Any = SimpleNamespace(addinivalue_line=lambda *line: told.append(line))
    pytest_configure(config)
    assert told == [("markers", "lab(network, plant, seed): which lab the fixture `lab` is")]


@pytest.mark.parametrize("mark", [None, SimpleNamespace(args=("serial",), kwargs={"seed": 3})])
def test_the_fixture_is_the_lab_of_its_mark(mark: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    from contextlib import nullcontext

    from scenarios.lab import fixture

    monkeypatch.setattr(labs, "Lab", lambda *given, **more: nullcontext((given, more)))
    request: Any = SimpleNamespace(node=SimpleNamespace(get_closest_marker={"lab": mark}.__getitem__))
    plain: Any = fixture.lab
    made = next(plain.__wrapped__(request))
    assert made == ((), {}) if mark is None else made == (("serial",), {"seed": 3})
