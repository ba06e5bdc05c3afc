"""Faults of boards by themselves: supplies that several faults hold, resets, crystals, and their proof."""

from typing import Any

import pytest

from bus.can import Frame
from scenarios.lab.faults.onboard import (
    BrownOut,
    Deaf,
    Drift,
    Hears,
    NoSupply,
    Resets,
    took_down,
)
from tests.scenarios.lab.faults.stub import acted, place

ONE, OTHER = Frame(0x123, b"\1"), Frame(0x124, b"\2")
MS = 1_000_000


def test_ears_miss_what_they_are_told_and_pass_on_the_rest() -> None:
    where, heard = place(), list[Frame]()
    port: Any = where.board("A").port
    port.on_receive = lambda t_ns, frame: heard.append(frame)
    ears = Hears(where, port, lambda frame: frame == ONE)
    port.on_receive(1, OTHER)
    assert where.evidence.first_ns is None
    port.on_receive(2, ONE)
    assert heard == [OTHER] and acted(where.evidence) == (2, "frame 123#01")
    ears.clear(3)
    Deaf(where, {"node": "A"}, 0)
    port.on_receive(3, OTHER)
    assert heard == [OTHER]


@pytest.mark.parametrize(("on", "boot_ns", "acts"), [(True, 0, True), (False, 6, True), (False, 5, False)])
def test_a_board_that_is_down_cannot_be_taken_down(on: bool, boot_ns: int, acts: bool) -> None:
    where = place()
    board = where.board("A")
    board.on, board._boot_ns = on, boot_ns
    took_down(board, 5, where.evidence)
    assert where.evidence.on == ("supply of A" if acts else "")


@pytest.mark.parametrize(("kind", "word"), [(NoSupply, "off"), (BrownOut, "reset")])
def test_the_first_takes_a_supply_and_the_last_gives_it_back(kind: type[NoSupply], word: str) -> None:
    where = place()
    board = where.board("A")
    first, second = kind(where, {"node": "A"}, 1), kind(where, {"node": "A"}, 2)
    assert board.calls == [(word, 1)] and where.evidence.first_ns == 1
    first.clear(3)
    second.clear(4)
    assert board.calls == [(word, 1), ("on", 4)]


def test_a_second_one_acts_from_when_the_first_is_over() -> None:
    where = place()
    other = place()
    held: Any = other.held
    first = NoSupply(where, {"node": "A"}, 1)
    held["A"] = 1  # somebody else's
    second = NoSupply(other, {"node": "A"}, 2)
    assert other.evidence.first_ns is None
    other.let_go("A")
    second.clear(6)
    assert acted(other.evidence) == (6, "supply of A")
    where.board("A").on = False
    first.clear(7)
    assert where.evidence.first_ns == 1


def test_a_brown_out_s_controller_hears_nothing_more() -> None:
    where, heard = place(), list[Frame]()
    port: Any = where.board("A").port
    port.on_receive = lambda t_ns, frame: heard.append(frame)
    low = BrownOut(where, {"node": "A"}, 1)
    port.on_receive(2, ONE)
    low.clear(3)
    port.on_receive(4, OTHER)
    assert heard == [OTHER]


def test_resets_come_at_once_and_every_so_often_until_they_are_cleared() -> None:
    where = place()
    board, queue = where.board("A"), where.network.queue
    resets: Any = Resets(where, {"node": "A", "every": 40.0}, 10)
    assert board.calls == [("off", 10), ("on", 10)] and where.evidence.first_ns == 10
    assert queue.step() == 10 + 40_000 * MS  # type: ignore[attr-defined]
    assert board.calls[2:] == [("off", 10 + 40_000 * MS), ("on", 10 + 40_000 * MS)]
    resets.clear(50_000 * MS)
    assert not queue.due  # type: ignore[attr-defined]
    resets._reset(60_000 * MS)
    assert len(board.calls) == 4


def test_a_reset_of_a_board_without_supply_changes_nothing_and_one_is_enough() -> None:
    where = place()
    NoSupply(where, {"node": "A"}, 1)
    Resets(where, {"node": "A"}, 2)
    assert where.board("A").calls == [("off", 1)]
    assert not where.network.queue.due  # type: ignore[attr-defined]


def test_a_crystal_keeps_what_it_has_gained_and_shows_two_periods_later() -> None:
    where = place()
    board, queue = where.board("A"), where.network.queue
    drift = Drift(where, {"node": "A", "ppm": 500.0}, 1)
    assert board.calls == [("pull 500", 1), ("retime", 0)]
    board.on = False
    assert queue.step() == 1 + 10 * MS and where.evidence.first_ns is None  # type: ignore[attr-defined]
    board.on = True
    assert queue.step() == 1 + 20 * MS  # type: ignore[attr-defined]
    assert acted(where.evidence) == (1 + 20 * MS, "timer interrupt of A")
    drift.clear(30 * MS)
    assert board.calls[2:] == [("pull -500", 30 * MS), ("retime", 0)]


def test_a_crystal_that_is_right_shows_nothing_and_one_that_was_cleared_no_more() -> None:
    where = place()
    Drift(where, {"node": "A", "ppm": 0.0}, 1)
    assert not where.network.queue.due  # type: ignore[attr-defined]
    Drift(where, {"node": "A", "ppm": 5.0}, 1).clear(2)
    assert not where.network.queue.due  # type: ignore[attr-defined]
