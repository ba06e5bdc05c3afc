"""The wire tells arbitrations in advance: whatever comes before the first bit is over still counts."""

import pytest

from bus.can import Frame, Wire
from bus.can.length import frame_bits
from bus.time import EventQueue

BIT_NS = 1000
DATA = bytes(range(8))
Log = list[tuple[int, int]]


def network(nodes: int) -> tuple[EventQueue, Wire, Log]:
    """A wire at 1 Mbit/s whose good frames are logged as (end, identifier)."""
    queue = EventQueue()
    wire = Wire(queue)
    for number in range(nodes):
        wire.attach(f"n{number}")
    log: Log = []
    wire.tap(lambda t_ns, frame, _: log.append((t_ns, frame.identifier)))
    return queue, wire, log


def end_ns(start_ns: int, identifier: int) -> int:
    """End of EOF of a frame with DATA that starts at `start_ns`."""
    return start_ns + (frame_bits(Frame(identifier, DATA)) - 3) * BIT_NS


def test_L1_a_lower_identifier_within_the_first_bit_wins() -> None:
    queue, wire, log = network(3)
    wire.ports[0].send(Frame(0x200, DATA), 50_000)
    queue.run_until(50_600)
    wire.ports[1].send(Frame(0x100, DATA), 50_900)
    queue.run_until(1_000_000)
    first = end_ns(50_000, 0x100)
    assert log == [(first, 0x100), (end_ns(first + 3 * BIT_NS, 0x200), 0x200)]


@pytest.mark.parametrize(("ready_ns", "first"), [(51_000, 0x100), (51_001, 0x200)])
def test_L1_the_first_bit_counts_to_its_end(ready_ns: int, first: int) -> None:
    """Told in advance or seen when it comes: ready with the bit's last nanosecond is in, one later is out."""
    for seen_ns in (40_000, 50_999, 51_000):
        queue, wire, log = network(3)
        wire.ports[0].send(Frame(0x200, DATA), 50_000)
        queue.run_until(seen_ns)
        wire.ports[1].send(Frame(0x100, DATA), ready_ns)
        queue.run_until(1_000_000)
        assert log[0] == (end_ns(50_000, first), first)


def test_L1_an_earlier_start_wins_whatever_its_identifier() -> None:
    queue, wire, log = network(3)
    wire.ports[0].send(Frame(0x100, DATA), 50_000)
    wire.ports[1].send(Frame(0x200, DATA), 20_000)
    queue.run_until(1_000_000)
    assert [identifier for _, identifier in log] == [0x200, 0x100]
    assert log[0][0] == end_ns(20_000, 0x200)


def test_L1_a_node_that_goes_off_before_its_frame_starts_leaves_no_trace() -> None:
    queue, wire, log = network(3)
    wire.ports[0].send(Frame(0x100, DATA), 50_000)
    wire.ports[1].send(Frame(0x200, DATA), 60_000)
    queue.run_until(40_000)
    wire.ports[0].online = False
    queue.run_until(1_000_000)
    assert log == [(end_ns(60_000, 0x200), 0x200)]
    assert not any(wire.errors.values())


def test_L1_who_disturbs_is_asked_about_frames_that_were_sent_before() -> None:
    queue, wire, log = network(2)
    asked: Log = []
    wire.ports[0].send(Frame(0x100, DATA), 50_000)
    queue.run_until(40_000)
    wire.disturb(lambda t_ns, frame, _: asked.append((t_ns, frame.identifier)))
    queue.run_until(1_000_000)
    assert asked == [(50_000, 0x100)]
    assert log == [(end_ns(50_000, 0x100), 0x100)]


def test_L1_trouble_does_not_hold_up_who_is_waiting() -> None:
    queue, wire, log = network(3)
    wire.ports[0].send(Frame(0x100, DATA), 0)
    queue.run_until(20_000)
    wire.ports[1].send(Frame(0x200, DATA), 20_000)  # waits for the bus
    wire.disturb(lambda *_: None)
    wire.ports[2].send(Frame(0x300, DATA), 500_000)
    queue.run_until(2_000_000)
    first = end_ns(0, 0x100)
    second = end_ns(first + 3 * BIT_NS, 0x200)
    assert log == [(first, 0x100), (second, 0x200), (end_ns(500_000, 0x300), 0x300)]


def test_L1_equal_identifiers_collide_behind_a_lower_one_that_is_not_ready() -> None:
    queue, wire, _ = network(4)
    wire.ports[0].send(Frame(0x50, DATA), 0)
    queue.run_until(10_000)
    wire.ports[3].send(Frame(0x60, DATA), 900_000)
    wire.ports[1].send(Frame(0x100, DATA), 20_000)
    wire.ports[2].send(Frame(0x100, DATA[::-1]), 20_000)
    queue.run_until(600_000)
    assert wire.errors["bit"], "both sent 0x100 at once"
