"""What speaks for everything behind a door, and a bus whose program waits in one thread."""

import can
import pytest

from bus.can import Frame, Wire
from bus.can.frame import FrameError
from bus.outside.lockstep import LockstepBus
from bus.outside.messages import to_frame, to_message
from bus.outside.node import OutsideNode
from bus.time import EventQueue


def test_frames_wait_in_order_for_three_buffers() -> None:
    """The lowest identifier would go first from the buffers; behind them the order stays."""
    queue = EventQueue()
    wire = Wire(queue)
    node = OutsideNode(queue, wire)
    heard: list[int] = []
    wire.attach("board").on_receive = lambda _t, frame: heard.append(frame.identifier)
    assert node.room == 1000
    for identifier in (9, 8, 7, 6, 5):
        node.arrive(Frame(identifier, b""))
    assert [frame.identifier for frame in node.waiting] == [6, 5]
    assert node.room == 998
    queue.run_until(1_000_000)
    assert sorted(heard) == [5, 6, 7, 8, 9]
    assert heard[0] == 7
    assert (node.room, len(node.waiting)) == (1000, 0)


def test_a_frame_that_no_wire_carries_is_refused_and_does_not_wait() -> None:
    queue = EventQueue()
    node = OutsideNode(queue, Wire(queue))
    with pytest.raises(FrameError):
        node.arrive(Frame(0x800, b""))
    assert (node.room, len(node.waiting)) == (1000, 0)


def test_room_is_never_less_than_none() -> None:
    queue = EventQueue()
    node = OutsideNode(queue, Wire(queue))  # alone: nobody acknowledges
    for _ in range(1005):
        node.arrive(Frame(1, b""))
    assert (len(node.waiting), node.room) == (1002, 0)


def test_a_node_has_the_name_it_is_given() -> None:
    queue = EventQueue()
    wire = Wire(queue)
    assert [OutsideNode(queue, wire).port.name, OutsideNode(queue, wire, "fence").port.name] == [
        "outside", "fence",
    ]  # fmt: skip


def test_the_answer_is_there_when_send_returns() -> None:
    wire = Wire(EventQueue())
    board = wire.attach("board")

    def answer(t_ns: int, frame: Frame) -> None:
        board.send(Frame(0x111, frame.data), t_ns + 1_000_000)

    board.on_receive = answer
    got: list[can.Message] = []
    with LockstepBus(wire, got.append) as bus:
        bus.send(can.Message(arbitration_id=0x91, data=b"x", is_extended_id=False))
        assert wire.queue.now_ns == 5_000_000
        assert [(message.arbitration_id, bytes(message.data)) for message in got] == [(0x111, b"x")]
        bus.after_s = 0.0
        bus.send(can.Message(arbitration_id=0x92, data=b"y", is_extended_id=False))
        assert (wire.queue.now_ns, len(got)) == (5_000_000, 1)
        bus.run(0.002)
        assert (wire.queue.now_ns, len(got)) == (7_000_000, 2)
        bus.run(1e-10)  # the least there is
        assert wire.queue.now_ns == 7_000_001


def test_a_lockstep_bus_waits_as_long_as_it_is_told() -> None:
    wire = Wire(EventQueue())
    wire.attach("board")
    with LockstepBus(wire, lambda _: None, after_s=0.25) as bus:
        bus.send(can.Message(arbitration_id=0x91, is_extended_id=False))
    assert wire.queue.now_ns == 250_000_000


@pytest.mark.parametrize(("frame", "dlc"), [
    (Frame(0x7FF, b"\x01\x02"), 2), (Frame(0x1FFFFFFF, b"", extended=True), 0),
    (Frame(0x10, bytes(8), remote=True), 8),
])  # fmt: skip
def test_a_frame_is_the_same_there_and_back(frame: Frame, dlc: int) -> None:
    message = to_message(frame, 1_500_000_000, "lab", is_rx=False)
    assert (message.timestamp, message.channel, message.is_rx, message.dlc) == (1.5, "lab", False, dlc)
    assert (message.is_extended_id, message.is_remote_frame) == (frame.extended, frame.remote)
    assert bytes(message.data) == (b"" if frame.remote else frame.data)
    assert to_frame(message) == frame
    assert to_message(frame, 0).is_rx and to_message(frame, 0).channel is None


def test_what_is_refused_is_named() -> None:
    for message, words in (
        (can.Message(arbitration_id=0x10, is_fd=True, data=bytes(12)), r"a CAN FD frame \(0x10\)"),
        (can.Message(arbitration_id=0x20, is_error_frame=True), r"an error frame \(0x20\)"),
        (can.Message(arbitration_id="x"), "'x' is no identifier"),  # type: ignore[arg-type]
        (can.Message(arbitration_id=1, dlc=9, is_remote_frame=True), "9 is no length"),
        (can.Message(arbitration_id=1, dlc=-1, is_remote_frame=True), "-1 is no length"),
    ):
        with pytest.raises(FrameError, match=words):
            to_frame(message)
    assert to_frame(can.Message(arbitration_id=1, dlc=0, is_remote_frame=True)).data == b""
