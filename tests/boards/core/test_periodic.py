import pytest

from boards.core import PeriodicBoard, Source
from bus.can import Frame, Wire
from bus.protocol import Device, Opcode, Result, pack_command, unpack_heartbeat, unpack_reply
from bus.time import EventQueue, Oscillator
from tests.boards.places import place

DEVICE = Device.MOTOR_DEC_B
MS = 1_000_000


class Idle(PeriodicBoard):
    """A board that does nothing but be there."""

    __slots__ = ("ends",)

    def reset(self) -> None:
        self.ends: list[int] = []

    def routine(self, t_ns: int) -> None:
        end = self.enter(t_ns)
        if end:
            self.ends.append(end)
            if self.ticks % 200 == 1:
                self.heartbeat(end)


def bench(tick_cycles: int) -> tuple[EventQueue, Idle, list[Frame]]:
    queue = EventQueue()
    wire = Wire(queue)
    table = (Source("tick", 2, 10, tick_cycles), Source("can", 1, 10, 1000, level=True))
    board = Idle(place(DEVICE, wire, Oscillator(0.0, 0)), 1_000_000, table, 5 * MS)
    frames: list[Frame] = []
    pc = wire.attach("pc")
    pc.on_receive = lambda _t, frame: frames.append(frame)
    board.begin()
    return queue, board, frames


def test_B9_ticks_come_in_time_and_their_outputs_at_the_end() -> None:
    queue, board, _ = bench(tick_cycles=100)
    queue.run_until(26 * MS)
    assert board.ends == [k * 5 * MS + 10_000 + 100_000 for k in range(1, 6)]
    assert board.cpu.overruns == 0


def test_B9_a_routine_longer_than_its_period_loses_ticks_and_counts_them() -> None:
    queue, board, frames = bench(tick_cycles=12_000)
    queue.run_until(1200 * MS)
    # 12 ms of work every 5 ms: it runs back to back, and of 240 fires 100 are served
    assert abs(len(board.ends) - 100) <= 1
    assert abs(board.cpu.overruns + len(board.ends) - 240) <= 3
    heartbeat = unpack_heartbeat([f for f in frames if f.identifier == 0x734][-1].data)
    # by the end of the first routine, from 5 to 17 ms, one fire was remembered and one was lost
    assert heartbeat.overruns == 1


def test_B9_commands_wait_for_the_tick_and_are_answered() -> None:
    queue, board, frames = bench(tick_cycles=3000)
    assert board.port.state == "active"
    queue.run_until(5 * MS + 500_000)
    board._receive(queue.now_ns, Frame(0x080 + DEVICE, pack_command(DEVICE, Opcode.PING)))
    queue.run_until(20 * MS)
    replies = [unpack_reply(f.data) for f in frames if f.identifier == 0x100 + DEVICE]
    assert [reply.result for reply in replies] == [Result.OK]


def test_a_board_without_supply_is_silent_and_boots_afresh() -> None:
    queue, board, frames = bench(tick_cycles=100)
    queue.run_until(2500 * MS)
    board.power_off(queue.now_ns)
    frames.clear()
    queue.run_until(5000 * MS)
    assert not frames
    board.power_on(queue.now_ns)
    queue.run_until(5290 * MS)
    assert not frames
    queue.run_until(6501 * MS)
    beats = [unpack_heartbeat(f.data) for f in frames if f.identifier == 0x734]
    assert [beat.uptime for beat in beats] == [0, 1]
    assert len(board.ends) == 240


@pytest.mark.slow
@pytest.mark.parametrize("ppm", [-9000.0, 0.0, 9000.0])
def test_B9_a_board_knows_the_time_from_its_own_timer_only(ppm: float) -> None:
    queue = EventQueue()
    table = (Source("tick", 2, 10, 100), Source("can", 1, 10, 1000, level=True))
    crystal = Oscillator(ppm, 123_456_789)
    board = Idle(place(DEVICE, Wire(queue), crystal), 1_000_000, table, 5 * MS)
    heard: list[int] = []
    board.mail[0x123] = lambda now_ns, _data: heard.append(now_ns)
    board.begin()
    queue.run_until(12 * MS)
    for _ in range(2):
        board._receive(queue.now_ns, Frame(0x123, bytes([0x23, *7 * [0]])))
        queue.run_until(queue.now_ns + 10_000 * MS)
    # ten true seconds are more or less than that by the board's crystal; within a period the timer runs true
    assert heard[1] - heard[0] == pytest.approx(
        10_000 * MS * (1 + ppm * 1e-6), abs=5 * MS * abs(ppm) * 1e-6 + 2
    )
    assert board.clock_ns(queue.now_ns) // 1_000_000_000 == (20 if ppm >= 0 else 19)


def test_a_clock_is_right_before_the_first_tick_and_a_board_that_is_off_enters_nothing() -> None:
    queue, board, _ = bench(tick_cycles=100)
    assert board.clock_ns(5 * MS + 10_000) == 5 * MS  # the first routine begins 10 us after its fire
    queue.run_until(6 * MS)
    assert (board.ticks, board.clock_ns(5 * MS + 10_000)) == (1, 5 * MS)
    board.power_off(queue.now_ns)
    assert board.enter(queue.now_ns) == 0
    assert board.ticks == 1


def test_a_tick_takes_its_time_from_a_command_that_is_being_served() -> None:
    """A command of 1010 us that comes at 4.5 ms is through at 5.51 ms, and 100 us later with a tick in it."""
    queue, board, frames = bench(tick_cycles=100)
    queue.run_until(4 * MS + 500_000)
    board._receive(queue.now_ns, Frame(0x080 + DEVICE, pack_command(DEVICE, Opcode.PING)))
    line = board.cpu.lines["can"]
    queue.run_until(5 * MS)
    assert line.end_ns == 5 * MS + 510_000
    queue.run_until(5 * MS + 600_000)
    assert (line.end_ns, line.runs) == (5 * MS + 610_000, 0)
    queue.run_until(6 * MS)
    assert line.runs == 1
    assert sum(frame.identifier == 0x100 + DEVICE for frame in frames) == 1
