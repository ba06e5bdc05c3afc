"""What a door lets through at a time, what it remembers of its own, and which errors are the interface's."""

from collections.abc import Iterator

import can
import pytest

from bus.can import Frame, Wire
from bus.outside import door as module
from bus.outside.door import Door, echoes, is_broken
from bus.time import EventQueue
from tests.bus.outside.test_door import MESSAGE, Joined, Outside

OUR = Frame(0x211, b"\x11")


class Clock:
    now_s = 50.0

    def __call__(self) -> float:
        return self.now_s


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(module, "monotonic", clock)
    return clock


@pytest.fixture
def joined() -> Iterator[Joined]:
    joined = Joined()
    yield joined
    joined.outside.shutdown()


@pytest.fixture
def echoing(clock: Clock, monkeypatch: pytest.MonkeyPatch, joined: Joined) -> Joined:
    """Beyond the door a bus that hears itself."""
    monkeypatch.setattr(Outside, "__module__", "can.interfaces.udp_multicast.bus")
    joined.door.close()
    joined.door = Door(joined.queue, joined.wire, joined.outside)
    return joined


def sent(joined: Joined, *frames: Frame) -> list[can.Message]:
    """What of the board's frames came out just now."""
    joined.outside.out.clear()
    for frame in frames:
        joined.node.send(frame, joined.queue.now_ns)
    joined.queue.run_until(joined.queue.now_ns + 1_000_000)
    return list(joined.outside.out)


def test_a_poll_brings_in_64_frames_and_the_next_one_the_rest(joined: Joined) -> None:
    joined.outside.into.extend([MESSAGE] * 100)
    joined.door.poll()
    assert (joined.door.frames_in, len(joined.outside.into)) == (64, 36)
    joined.door.poll()
    assert (joined.door.frames_in, joined.door.refused, joined.door.rejected) == (100, 0, 0)


def test_a_new_door_has_counted_nothing(joined: Joined) -> None:
    door = joined.door
    assert (door.frames_in, door.frames_out, door.refused, door.lost_out, door.rejected) == (0, 0, 0, 0, 0)
    assert door.system_lost == 0


def test_every_frame_counts(joined: Joined) -> None:
    assert len(sent(joined, OUR, Frame(0x212, b""))) == 2
    assert joined.door.frames_out == 2
    joined.outside.broken = True
    sent(joined, OUR, OUR)
    assert (joined.door.frames_out, joined.door.lost_out) == (2, 2)


def test_what_is_no_frame_counts_and_an_error_frame_does_not(joined: Joined) -> None:
    fd = can.Message(arbitration_id=1, is_fd=True, data=bytes(12))
    joined.outside.into.extend([fd, fd, can.Message(is_error_frame=True)])
    joined.door.poll()
    assert (joined.door.rejected, joined.door.frames_in) == (2, 0)


def test_frames_may_enter_elsewhere() -> None:
    queue = EventQueue()
    outside, entered = Outside(), list[Frame]()
    door = Door(queue, Wire(queue), outside, enter=entered.append)
    outside.into.append(MESSAGE)
    door.poll()
    outside.shutdown()
    assert entered == [Frame(0x091, b"\x11\x01")]
    assert door.frames_in == 1


def test_what_goes_out_bears_the_time_and_is_no_reception(joined: Joined) -> None:
    joined.queue.run_until(1_000_000_000)
    (message,) = sent(joined, OUR)
    assert message.timestamp == pytest.approx(1.0, abs=1e-3) and message.timestamp > 1.0
    assert not message.is_rx


def test_a_full_node_complains_ten_times_a_second(joined: Joined, clock: Clock) -> None:
    node = joined.door._node
    node.waiting.extend([OUR] * 1000)
    times: list[float] = []
    for k in range(25):
        joined.outside.out.clear()
        clock.now_s = 50.0 + k * 0.01
        joined.outside.into.append(MESSAGE)
        joined.door.poll()
        if joined.outside.out:
            times.append(round(k * 0.01, 2))
    assert times == [0.0, 0.1, 0.2]
    assert joined.door.refused == 25
    joined.outside.out.clear()
    clock.now_s += 1.0
    joined.door.poll()
    assert joined.outside.out == []  # nothing was refused


def test_a_complaint_that_does_not_get_out_is_lost(joined: Joined, clock: Clock) -> None:
    joined.door._node.waiting.extend([OUR] * 1000)
    joined.outside.broken = True
    joined.outside.into.append(MESSAGE)
    joined.door.poll()
    assert (joined.door.lost_out, joined.door.refused) == (1, 1)


def test_an_echo_is_taken_for_one_once(echoing: Joined) -> None:
    out = sent(echoing, OUR)
    echoing.outside.into.extend([*out, *out])  # the second one is somebody else's
    echoing.door.poll()
    assert echoing.door.frames_in == 1


def test_echoes_may_come_in_another_order(echoing: Joined) -> None:
    out = sent(echoing, OUR, Frame(0x212, b""), Frame(0x213, b""))
    echoing.outside.into.extend([out[1], out[2], out[0], MESSAGE])
    echoing.door.poll()
    assert (echoing.door.frames_in, echoing.door.rejected, echoing.door.refused) == (1, 0, 0)


@pytest.mark.parametrize(("late_s", "entered"), [(1.5, 0), (2.0, 0), (2.5, 1)])
def test_an_echo_is_expected_for_two_seconds(
    echoing: Joined, clock: Clock, late_s: float, entered: int
) -> None:
    out = sent(echoing, OUR)
    clock.now_s += late_s
    echoing.outside.into.extend(out)
    echoing.door.poll()
    assert echoing.door.frames_in == entered


def test_a_bus_without_echoes_has_none(joined: Joined) -> None:
    assert not echoes(joined.outside)
    out = sent(joined, OUR)
    joined.outside.into.extend(out)
    joined.door.poll()
    assert joined.door.frames_in == 1


def test_a_closed_door_lets_nothing_out(joined: Joined) -> None:
    joined.door.close()
    assert sent(joined, OUR) == []
    assert joined.door._node.port.on_error is None
    assert joined.door.frames_out == 0


def caused(*causes: BaseException) -> can.CanError:
    """An error with a chain of causes."""
    error: BaseException = can.CanOperationError("no")
    first = error
    for each in causes:
        error.__cause__ = each
        error = each
    assert isinstance(first, can.CanError)
    return first


def test_an_error_with_the_system_behind_it_is_the_interfaces() -> None:
    assert is_broken(caused())
    assert is_broken(caused(OSError(100, "down")))
    assert is_broken(caused(ValueError("odd"), OSError(100, "down")))
    assert not is_broken(caused(ValueError("odd")))
    assert not is_broken(caused(ValueError("odd"), KeyError("odd")))
