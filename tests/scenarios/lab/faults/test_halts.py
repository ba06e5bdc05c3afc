"""Processors that stand still, by themselves: what proves it, who holds them, and masks that come again."""

from typing import Any

import pytest

from bus.can import Frame
from scenarios.lab.faults import onboard
from scenarios.lab.faults.onboard import Hang, LateInterrupts
from tests.scenarios.lab.faults.stub import acted, place

ONE = Frame(0x123, b"\1")
S = 1_000_000_000


class StubHalt:
    """Keeps what it hears."""

    due: int | None = 30

    def __init__(self, board: Any, t_ns: int) -> None:
        self.board, self.due_ns = board, self.due
        self.board.calls.append(("halt", t_ns))

    def hear(self, t_ns: int, frame: Frame) -> None:
        self.board.calls.append(("hear", t_ns))

    def resume(self, t_ns: int) -> None:
        self.board.calls.append(("resume", t_ns))


@pytest.fixture
def halt(monkeypatch: pytest.MonkeyPatch) -> type[StubHalt]:
    monkeypatch.setattr(onboard, "Halt", StubHalt)
    return StubHalt


@pytest.mark.parametrize(
    ("due_ns", "on", "acts_ns"), [(30, True, 30), (5, True, 10), (30, False, None), (None, True, None)]
)
def test_a_hang_acts_with_the_first_interrupt_it_misses(
    halt: type[StubHalt], due_ns: int | None, on: bool, acts_ns: int | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(halt, "due", due_ns)
    where = place()
    board, queue = where.board("A"), where.network.queue
    board.on = on
    hang = Hang(where, {"node": "A"}, 10)
    assert len(queue.due) == (due_ns is not None)  # type: ignore[attr-defined]
    if due_ns is not None:
        queue.step()  # type: ignore[attr-defined]
    assert where.evidence.first_ns == acts_ns
    assert where.evidence.on == ("interrupt of A" if acts_ns else "")
    hang.clear(50)
    hang.clear(60)  # it is over once
    assert board.calls == [("halt", 10), ("resume", 50)]


def test_a_hang_that_is_over_waits_for_no_interrupt_and_a_frame_proves_it(halt: type[StubHalt]) -> None:
    where = place()
    board = where.board("A")
    hang = Hang(where, {"node": "A"}, 10)
    board.port.on_receive(12, ONE)
    assert acted(where.evidence) == (12, "frame 123#01")
    hang.clear(15)
    assert not where.network.queue.due and board.port.on_receive is None  # type: ignore[attr-defined]
    assert board.calls == [("halt", 10), ("hear", 12), ("resume", 15)]
    again = Hang(where, {"node": "A"}, 20)
    assert not where.network.queue.due  # type: ignore[attr-defined]
    again.clear(25)


def test_two_hangs_hold_one_processor(halt: type[StubHalt]) -> None:
    where = place()
    board = where.board("A")
    first, second = Hang(where, {"node": "A"}, 10), Hang(where, {"node": "A"}, 11)
    first.clear(20)
    assert board.calls == [("halt", 10)]
    board.port.on_receive(22, ONE)
    second.clear(30)
    assert board.calls[-1] == ("resume", 30) and not where.halted
    assert where.evidence.first_ns == 22


def test_interrupts_are_masked_for_a_while_again_and_again(halt: type[StubHalt]) -> None:
    where = place()
    board, queue = where.board("A"), where.network.queue
    halt.due = None
    late = LateInterrupts(where, {"node": "A", "masked": 2.0, "every": 5.0}, 0)
    steps = [queue.step() for _ in range(4)]  # type: ignore[attr-defined]
    halt.due = 30
    assert steps == [2 * S, 5 * S, 7 * S, 10 * S]
    assert board.calls == [
        ("halt", 0),
        ("resume", 2 * S),
        ("halt", 5 * S),
        ("resume", 7 * S),
        ("halt", 10 * S),
    ]
    late.clear(11 * S)
    assert board.calls[-1] == ("resume", 11 * S) and not queue.due  # type: ignore[attr-defined]


@pytest.mark.parametrize("masked", [0.005, 0.006])
def test_a_mask_that_never_ends_is_refused(masked: float) -> None:
    with pytest.raises(ValueError, match=r"^late_interrupts: masked has to be shorter than every$"):
        LateInterrupts(place(), {"node": "A", "masked": masked, "every": 0.005}, 0)
