from itertools import pairwise

from hypothesis import given, settings
from hypothesis import strategies as st

from boards.motor_velocity.firmware import FCY_HZ, TABLE, MotorVelocityBoard
from bus.can import Frame, Wire
from bus.protocol import Device, unpack_tach
from bus.time import EventQueue, Oscillator
from tests.boards.places import place
from tests.boards.tables import times_ns


@settings(deadline=None, max_examples=25)
@given(st.lists(st.integers(-30_000, 30_000), min_size=3, max_size=20), st.integers(-(2**40), 2**40))
def test_B4_counts_are_the_sum_of_what_the_shaft_turned(moves: list[int], start: int) -> None:
    queue = EventQueue()
    wire = Wire(queue)
    counts = [start]
    for move in moves:
        counts.append(counts[-1] + move)
    board = MotorVelocityBoard(
        place(Device.MOTOR_RA_A, wire, Oscillator(0.0, 0)),
        lambda t_ns: counts[min(t_ns // 10_000_000, len(moves))],
    )
    frames: list[Frame] = []
    wire.attach("pc").on_receive = lambda _t, frame: frames.append(frame)
    board.begin()
    queue.run_until(10_000_000 * len(moves) + 5_000_000)
    tachs = [unpack_tach(frame.data) for frame in frames if frame.identifier == 0x231]
    assert [tach.delta for tach in tachs] == moves
    assert (tachs[-1].counts - sum(moves)) % 2**32 == 0


def test_B4_power_up_counts_from_nothing_wherever_the_motor_stands() -> None:
    """TACH every 10 ms with the counts of them, HEARTBEAT every second; 7 counts a millisecond."""
    queue = EventQueue()
    wire = Wire(queue)
    board = MotorVelocityBoard(
        place(Device.MOTOR_RA_A, wire, Oscillator(0.0, 0)), lambda t_ns: 50_000 + 7 * (t_ns // 1_000_000)
    )
    frames: list[tuple[int, Frame]] = []
    wire.attach("pc").on_receive = lambda t_ns, frame: frames.append((t_ns, frame))
    assert (board.count, board.poscnt) == (0, 50_000)
    board.begin()
    for pause_s in (3, 2):
        queue.run_until(queue.now_ns + pause_s * 1_000_000_000)
        for identifier, period_ns in ((0x231, 10_000_000), (0x731, 1_000_000_000)):
            times = [t_ns for t_ns, frame in frames if frame.identifier == identifier]
            assert all(abs(after - before - period_ns) < 300_000 for before, after in pairwise(times))
        tachs = [unpack_tach(frame.data) for _, frame in frames if frame.identifier == 0x231]
        assert len(tachs) in (pause_s * 100, pause_s * 100 - 1)
        assert sum(frame.identifier == 0x731 for _, frame in frames) == pause_s
        assert [tach.counts for tach in tachs] == [70 * (k + 1) for k in range(len(tachs))]
        assert {tach.delta for tach in tachs} == {70}
        assert {tach.flags for tach in tachs} == {0}
        board.power_off(queue.now_ns)
        queue.run_until(queue.now_ns + 500_000_000)
        frames.clear()
        board.begin(queue.now_ns)


def test_B4_a_frame_that_finds_no_room_is_counted() -> None:
    """Ten TACH and a HEARTBEAT, three buffers, and nobody who acknowledges."""
    queue = EventQueue()
    wire = Wire(queue)
    board = MotorVelocityBoard(place(Device.MOTOR_RA_A, wire, Oscillator(0.0, 0)), lambda _t: 0)
    board.begin()
    queue.run_until(101_000_000)
    assert board.dropped == 10 + 1 - 3


def test_B4_routines_take_the_times_that_are_published() -> None:
    assert times_ns(TABLE, FCY_HZ) == {"sample": (1200, 40_000), "can": (1200, 60_000)}
    assert [line.level for line in TABLE] == [line.name == "can" for line in TABLE]
