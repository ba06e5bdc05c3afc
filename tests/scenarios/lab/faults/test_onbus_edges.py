"""Faults of the bus by themselves: parted, at a wrong rate, held dominant, with bit errors."""

from typing import Any

import pytest

from bus.can import Flip, Frame
from bus.can.length import frame_bits
from bus.can.port import BusError
from scenarios.lab.faults import onbus
from scenarios.lab.faults.onbus import BitErrors, Cut, Dominant, WrongRate
from tests.scenarios.lab.faults.stub import acted, place

ONE = Frame(0x123, b"\1")


def test_all_boards_cannot_be_parted_nor_one_twice(monkeypatch: pytest.MonkeyPatch) -> None:
    where = place("A", "B", "C")
    with pytest.raises(ValueError, match=r"^partition: nodes: some boards, not all of them$"):
        Cut(where, {"nodes": ["A", "B", "C"]}, 0)
    made: list[Any] = []
    healed: list[int] = []

    class Stub:
        def __init__(self, *each: Any) -> None:
            made.extend(each)

        def heal(self, t_ns: int) -> None:
            healed.append(t_ns)

    monkeypatch.setattr(onbus, "Partition", Stub)
    cut: Any = Cut(where, {"nodes": ["A", "B"]}, 3)
    ports: Any = [where.board(name).port for name in ("A", "B")]
    assert made[:3] == [where.network.wire, ports, 3]
    ports[0].online = ports[1].online = False
    made[3](4, ONE, "C")
    assert where.evidence.first_ns is None  # nobody is there to miss it
    ports[1].online = True
    made[3](5, ONE, "C")
    assert acted(where.evidence) == (5, "frame 123#01")
    cut.clear(6)
    assert healed == [6]
    ports[1]._wire = None
    with pytest.raises(ValueError, match=r"^partition: nodes: one of them is cut off already$"):
        Cut(where, {"nodes": ["A", "B"]}, 7)


def test_a_wrong_rate_is_the_last_one_given_and_errors_are_its_own_meanwhile() -> None:
    where = place()
    port: Any = where.board("A").port
    first: Any = WrongRate(where, {"node": "A", "bitrate": 250_000}, 0)
    assert port.timing.bit_ns == pytest.approx(4000.0)
    port.on_error(3, BusError("stuff"))
    assert where.evidence.on == "stuff error at A"
    second: Any = WrongRate(where, {"node": "A", "bitrate": 125_000}, 0)
    assert port.timing.bit_ns == pytest.approx(8000.0)
    first.clear(0)
    assert port.timing.bit_ns == pytest.approx(8000.0)
    second.clear(0)
    assert port.timing is None and port.on_error is None


def test_a_bus_is_held_by_the_first_and_let_go_by_the_last(monkeypatch: pytest.MonkeyPatch) -> None:
    held: list[int] = []
    freed: list[int] = []

    class Stub:
        def __init__(self, _wire: Any, t_ns: int) -> None:
            held.append(t_ns)

        def release(self, t_ns: int) -> None:
            freed.append(t_ns)

    monkeypatch.setattr(onbus, "StuckDominant", Stub)
    where = place()
    first, second = Dominant(where, {}, 1), Dominant(where, {}, 2)
    assert held == [1]
    first.clear(3)
    assert not freed and where.evidence.first_ns is None
    second.clear(4)
    assert freed == [4] and acted(where.evidence) == (4, "the bus")
    assert where.board("A").port.on_error is None
    again = Dominant(other := place(), {}, 5)
    other.board("A").port.on_error(6, BusError("form"))
    assert other.evidence.on == "form error at A"
    again.clear(7)
    alone = Dominant(third := place(), {}, 8)
    alone.clear(9)
    assert third.evidence.first_ns is None  # it needs an error for its proof


@pytest.mark.parametrize(
    ("node", "sender", "meant"), [(None, "A", True), ("A", "A", True), ("B", "A", False)]
)
def test_bit_errors_meet_the_frames_of_one_node_or_of_all(node: str | None, sender: str, meant: bool) -> None:
    where = place()
    given = {"probability": 1.0} | ({"node": node} if node else {})
    BitErrors(where, given, 0)
    wire: Any = where.network.wire
    flips: list[Any] = [wire.disturbance(5, ONE, sender) for _ in range(300)]
    if not meant:
        assert set(flips) == {None} and where.evidence.first_ns is None
        return
    places = {flip.bit for flip in flips}
    assert isinstance(flips[0], Flip)
    assert places == set(range(frame_bits(ONE) - 3))  # all but the intermission
    assert where.evidence.on == "frame 123#01"


def test_bit_errors_pass_on_what_lies_below_and_meet_their_share() -> None:
    where = place()
    wire: Any = where.network.wire
    wire.disturbance = lambda t_ns, frame, sender: Flip(99)
    BitErrors(where, {"probability": 0.25}, 0)
    flips: list[Any] = [wire.disturbance(5, ONE, "A") for _ in range(2000)]
    assert flips.count(Flip(99)) == pytest.approx(1500, abs=80)
    none = place()
    BitErrors(none, {"probability": 0.0}, 0)
    wire = none.network.wire
    assert wire.disturbance(5, ONE, "A") is None
