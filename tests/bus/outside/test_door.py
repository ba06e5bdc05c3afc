from collections import deque
from typing import Any

import can
import pytest

from bus.can import Frame, Wire
from bus.outside.door import Door, echoes
from bus.time import EventQueue

MESSAGE = can.Message(arbitration_id=0x091, data=b"\x11\x01", is_extended_id=False)


class Outside(can.BusABC):
    """What is beyond the door: takes what comes out, holds what goes in."""

    channel_info = "outside"

    def __init__(self) -> None:
        super().__init__("outside")
        self.out: list[can.Message] = []
        self.into: deque[Any] = deque()
        self.broken = False

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.broken:
            raise can.CanOperationError("gone")
        self.out.append(msg)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        if self.into and isinstance(self.into[0], Exception):
            raise self.into.popleft()
        return (self.into.popleft() if self.into else None), False


class Joined:
    def __init__(self) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue)
        self.node = self.wire.attach("board")
        self.got: list[tuple[int, Frame]] = []
        self.node.on_receive = lambda t_ns, frame: self.got.append((t_ns, frame))
        self.outside = Outside()
        self.door = Door(self.queue, self.wire, self.outside)

    def run(self, ms: int = 1) -> None:
        self.door.poll()
        self.queue.run_until(self.queue.now_ns + ms * 1_000_000)


@pytest.fixture
def joined():  # type: ignore[no-untyped-def]
    joined = Joined()
    yield joined
    joined.outside.shutdown()


def test_frames_from_outside_are_stamped_at_the_fence_and_go_no_further(joined: Joined) -> None:
    joined.queue.run_until(5_000_000)
    joined.outside.into.append(MESSAGE)
    joined.run()
    ((t_ns, frame),) = joined.got
    assert 5_000_000 < t_ns < 5_100_000
    assert frame == Frame(0x091, b"\x11\x01")
    assert joined.outside.out == []
    assert (joined.door.frames_in, joined.door.frames_out) == (1, 0)


def test_frames_from_the_wire_go_out_once(joined: Joined) -> None:
    joined.node.send(Frame(0x211, b"\x11"), 0)
    joined.run()
    assert [(m.arbitration_id, bytes(m.data)) for m in joined.outside.out] == [(0x211, b"\x11")]
    joined.run(10)
    assert len(joined.outside.out) == 1


def test_a_burst_waits_for_transmit_buffers_and_a_flood_is_cut_off(joined: Joined) -> None:
    joined.outside.into.extend([MESSAGE] * 1500)
    for _ in range(30):
        joined.door.poll()
    joined.run(200)
    # Three were in transmit buffers when the thousand waiting places had filled up.
    assert len(joined.got) == 1003
    assert joined.door.refused == 1500 - 1003
    (error,) = [message for message in joined.outside.out if message.is_error_frame]
    assert (error.arbitration_id, error.data[1]) == (0x004, 0x01), "a full controller says so"


def test_outside_takes_part_in_arbitration(joined: Joined) -> None:
    joined.outside.into.append(MESSAGE)
    order: list[int] = []
    joined.wire.tap(lambda _t, frame, _s: order.append(frame.identifier))
    joined.node.send(Frame(0x700, b""), joined.queue.now_ns)
    joined.node.send(Frame(0x010, b""), joined.queue.now_ns)
    joined.run()
    assert order == [0x010, 0x091, 0x700]


def test_what_the_wire_cannot_carry_and_a_broken_interface_are_counted(joined: Joined) -> None:
    joined.outside.into.append(can.Message(arbitration_id=1, is_fd=True, data=bytes(12)))
    joined.outside.into.append(can.Message(is_error_frame=True))
    joined.outside.broken = True
    joined.node.send(Frame(0x211, b""), 0)
    joined.run()
    assert (joined.got, joined.door.rejected, joined.door.lost_out) == ([], 1, 1)


def unreadable() -> can.CanOperationError:
    error = can.CanOperationError("could not unpack received message")
    error.__cause__ = ValueError("not msgpack")
    return error


def test_a_message_that_is_none_is_counted_and_the_next_one_read(joined: Joined) -> None:
    joined.outside.into.extend([unreadable(), MESSAGE])
    joined.run()
    assert (joined.door.rejected, joined.door.frames_in) == (1, 1)


def test_an_interface_that_is_gone_is_said(joined: Joined) -> None:
    error = can.CanOperationError("Network is down")
    error.__cause__ = OSError(100, "Network is down")
    joined.outside.into.append(error)
    with pytest.raises(can.CanError, match="down"):
        joined.door.poll()


@pytest.mark.parametrize(
    "message",
    [
        can.Message(arbitration_id=1, dlc=15, is_remote_frame=True),
        can.Message(arbitration_id=0x900, is_extended_id=False, data=b""),
        can.Message(arbitration_id=-1, data=b""),
        can.Message(arbitration_id="x", data=b""),  # type: ignore[arg-type]
        can.Message(arbitration_id=1.5, data=b""),  # type: ignore[arg-type]
        can.Message(arbitration_id=1, dlc=1e300, is_remote_frame=True),  # type: ignore[arg-type]
        can.Message(arbitration_id=1, dlc=1 << 60, is_remote_frame=True),
        can.Message(arbitration_id=1, is_fd=True, data=bytes(64)),
    ],
)
def test_messages_that_no_can_controller_could_send(joined: Joined, message: can.Message) -> None:
    joined.outside.into.extend([message, MESSAGE])
    joined.run()
    assert [frame.identifier for _, frame in joined.got] == [0x091]
    assert joined.door.rejected == 1


def test_a_bus_that_echoes_does_not_send_our_frames_back_in(
    joined: Joined, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Outside, "__module__", "can.interfaces.udp_multicast.bus")
    assert echoes(joined.outside)
    door = Door(joined.queue, joined.wire, joined.outside)
    joined.door.close()
    assert joined.door.frames_out == 0
    joined.node.send(Frame(0x211, b"\x11"), 0)
    joined.run()
    joined.outside.into.extend(joined.outside.out)  # the echo of our own
    joined.outside.into.append(MESSAGE)  # and somebody else's
    door.poll()
    joined.run()
    assert [frame.identifier for _, frame in joined.got] == [0x091]


def test_a_virtual_bus_works_both_ways() -> None:
    queue = EventQueue()
    wire = Wire(queue)
    node = wire.attach("board")
    node.on_receive = lambda t_ns, frame: node.send(Frame(0x111, frame.data), t_ns) and None
    with (
        can.Bus(interface="virtual", channel="test-door") as inner,
        can.Bus(interface="virtual", channel="test-door") as outer,
    ):
        door = Door(queue, wire, inner)
        outer.send(MESSAGE)
        door.poll()
        queue.run_until(1_000_000)
        answer = outer.recv(timeout=1)
        assert answer is not None
        assert (answer.arbitration_id, bytes(answer.data)) == (0x111, b"\x11\x01")
