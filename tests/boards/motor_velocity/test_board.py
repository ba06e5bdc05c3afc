from hypothesis import given, settings
from hypothesis import strategies as st

from boards.motor_velocity.firmware import MotorVelocityBoard
from bus.can import Frame, Wire
from bus.protocol import Device, unpack_tach
from bus.time import EventQueue, Oscillator
from tests.boards.places import place


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
