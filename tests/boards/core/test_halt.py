"""A processor that stands still: what its timer, its routines and its CAN controller do meanwhile."""

import pytest

from boards.core.halt import RECEIVE_BUFFERS, Halt
from bus.can import Frame
from bus.protocol import COMMAND_BASE, Opcode, pack_command, unpack_reply
from bus.time import EventQueue
from tests.boards.core.test_periodic import DEVICE, MS, Idle, bench

US = 1000
PING = Frame(COMMAND_BASE + DEVICE, pack_command(DEVICE, Opcode.PING))


@pytest.fixture
def running() -> tuple[EventQueue, Idle, list[Frame]]:
    """A board of 5 ms at 12 ms; a tick begins 10 us after its fire and takes 100 us."""
    queue, board, frames = bench(tick_cycles=100)
    queue.run_until(12 * MS)
    return queue, board, frames


def halted(board: Idle, until_ns: int) -> Halt:
    """From now until then."""
    queue = board.queue
    halt = Halt(board, queue.now_ns)
    queue.run_until(until_ns)
    return halt


def ends_ms(board: Idle) -> list[float]:
    return [end / MS for end in board.ends]


def test_the_first_fire_meanwhile_is_remembered_and_the_others_are_lost(
    running: tuple[EventQueue, Idle, list[Frame]],
) -> None:
    queue, board, _ = running
    halt = halted(board, 27 * MS)
    assert halt.due_ns == 15 * MS + 10 * US
    assert ends_ms(board) == [5.11, 10.11]
    halt.resume(27 * MS)
    queue.run_until(41 * MS)
    assert ends_ms(board) == [5.11, 10.11, 27.1, 30.11, 35.11, 40.11]
    assert board.cpu.top.overruns == 2  # of 20 and 25 ms


def test_a_halt_between_two_fires_changes_nothing(running: tuple[EventQueue, Idle, list[Frame]]) -> None:
    queue, board, _ = running
    halted(board, 14 * MS).resume(14 * MS)
    queue.run_until(21 * MS)
    assert ends_ms(board) == [5.11, 10.11, 15.11, 20.11]
    assert (board.cpu.overruns, board.dropped) == (0, 0)


def test_a_halt_that_ends_with_a_fire_loses_none(running: tuple[EventQueue, Idle, list[Frame]]) -> None:
    queue, board, _ = running
    due_ns = 15 * MS + 10 * US
    halted(board, due_ns).resume(due_ns)
    queue.run_until(21 * MS)
    assert ends_ms(board) == [5.11, 10.11, 15.11, 20.11]
    assert board.cpu.overruns == 0


def test_two_frames_are_kept_and_the_rest_is_lost(running: tuple[EventQueue, Idle, list[Frame]]) -> None:
    queue, board, frames = running
    halt = halted(board, 13 * MS)
    board.port.on_receive = halt.hear
    assert RECEIVE_BUFFERS == 2  # of an MCP2515
    for number in range(5):
        halt.hear(13 * MS, PING if number < 2 else Frame(PING.identifier, b""))
    assert board.dropped == 3
    queue.run_until(30 * MS)
    assert not any(frame.identifier == 0x100 + DEVICE for frame in frames)
    halt.resume(30 * MS)
    queue.run_until(40 * MS)
    replies = [unpack_reply(frame.data) for frame in frames if frame.identifier == 0x100 + DEVICE]
    assert [(reply.opcode, reply.result) for reply in replies] == [(Opcode.PING, 0)] * 2


def test_a_routine_goes_on_from_where_it_stood(running: tuple[EventQueue, Idle, list[Frame]]) -> None:
    """A command takes 1010 us; it is halted in the middle for 7 ms, over a tick of 100 us."""
    queue, board, frames = running
    board._receive(12 * MS, PING)
    queue.run_until(12 * MS + 500 * US)
    line = board.cpu.lines["can"]
    assert line.end_ns == 13 * MS + 10 * US
    halt = halted(board, 19 * MS + 500 * US)
    halt.resume(19 * MS + 500 * US)
    assert line.end_ns == 20 * MS + 10 * US
    queue.run_until(20 * MS)
    assert line.runs == 0
    queue.run_until(24 * MS)
    assert line.runs == 1
    assert board.cpu.overruns == 0
    assert sum(frame.identifier == 0x100 + DEVICE for frame in frames) == 1


def test_a_board_that_was_switched_off_meanwhile_has_forgotten_it(
    running: tuple[EventQueue, Idle, list[Frame]],
) -> None:
    queue, board, frames = running
    board._receive(12 * MS, PING)
    halt = halted(board, 20 * MS)
    halt.hear(20 * MS, PING)
    board.power_off(20 * MS)
    board.power_on(21 * MS)
    queue.run_until(400 * MS)
    halt.resume(400 * MS)
    before = len(board.ends)
    queue.run_until(450 * MS)
    assert len(board.ends) - before == 10
    assert not any(frame.identifier == 0x100 + DEVICE for frame in frames)


def test_a_board_that_is_off_stays_so(running: tuple[EventQueue, Idle, list[Frame]]) -> None:
    queue, board, _ = running
    halt = halted(board, 13 * MS)
    board.power_off(13 * MS)
    halt.resume(20 * MS)
    queue.run_until(100 * MS)
    assert ends_ms(board) == [5.11, 10.11]
    assert queue.next_ns() is None


def test_without_a_timer_nothing_is_due() -> None:
    queue, board, _ = bench(tick_cycles=100)
    board.power_off(0)
    queue.run_until(20 * MS)
    assert Halt(board, 20 * MS).due_ns is None


def test_an_interrupt_that_comes_meanwhile_waits_and_is_served_at_once(
    running: tuple[EventQueue, Idle, list[Frame]],
) -> None:
    queue, board, frames = running
    halt = Halt(board, queue.now_ns)
    board._receive(12 * MS, PING)
    queue.run_until(14 * MS - 100 * US)
    line = board.cpu.lines["can"]
    assert (line.runs, line.pending) == (0, True)
    halt.resume(queue.now_ns)
    queue.run_until(15 * MS)  # its 1010 us are over, and the next tick has not come
    assert (line.runs, line.pending) == (1, False)
    queue.run_until(16 * MS)
    assert sum(frame.identifier == 0x100 + DEVICE for frame in frames) == 1
