from collections import deque

import can
import pytest

from bus.can import Frame, Wire
from bus.door import Door, echoes
from bus.time import EventQueue

MESSAGE = can.Message(arbitration_id=0x091, data=b"\x11\x01", is_extended_id=False)


class Outside(can.BusABC):
    """What is beyond the door: takes what comes out, holds what goes in."""

    channel_info = "outside"

    def __init__(self) -> None:
        super().__init__("outside")
        self.out: list[can.Message] = []
        self.into: deque[can.Message] = deque()
        self.broken = False

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        if self.broken:
            raise can.CanOperationError("gone")
        self.out.append(msg)

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
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
    assert joined.door.lost_in == 1500 - 1003


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


def test_a_bus_that_echoes_does_not_send_our_frames_back_in(
    joined: Joined, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(Outside, "__module__", "can.interfaces.udp_multicast.bus")
    assert echoes(joined.outside)
    door = Door(joined.queue, joined.wire, joined.outside)
    joined.door.close()
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
