"""What is set on a node of a bus that has been well for a while counts from the next frame on."""

from bus.can import Frame, Wire
from bus.can.sampling import BitTiming
from bus.time import EventQueue
from tests.bus.can.test_trouble_told import diaries
from tests.bus.can.test_wire import listen, network

FRAME = Frame(0x123, bytes.fromhex("0102030405060708"))


def well(nodes: int = 2) -> tuple[EventQueue, Wire]:
    """A bus that has carried the frame once."""
    queue, wire = network(nodes)
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert wire.frames == 1 and not wire.errors
    return queue, wire


def again(queue: EventQueue, wire: Wire, until_ns: int = 1_150_000) -> None:
    """The frame once more; 119 bits of a microsecond."""
    wire.ports[0].send(FRAME, 1_000_000)
    queue.run_until(until_ns)


def test_who_is_given_a_receiver_later_hears() -> None:
    queue, wire = well()
    log = listen(wire, 1)
    again(queue, wire)
    assert [frame for _, frame in log] == [FRAME]


def test_who_watches_is_told() -> None:
    queue, wire = well()
    _, listener = diaries(wire)
    again(queue, wire)
    assert [what for _, what in listener.told] == ["counted"]


def test_who_only_listens_does_not_acknowledge() -> None:
    queue, wire = well()
    wire.ports[1].listen_only = True
    again(queue, wire)
    assert wire.frames == 1 and wire.errors == {"ack": 1} and wire.ports[0].tec == 8
    assert wire.ports[1].rec == 0
    wire.ports[1].listen_only = False
    queue.run_until(2_000_000)
    # the second attempt had begun: another 8, and 1 less for the third
    assert wire.frames == 2 and wire.errors == {"ack": 2} and wire.ports[0].tec == 15


def test_a_timing_of_another_rate_does_not_understand() -> None:
    queue, wire = well()
    wire.ports[1].timing = BitTiming(500.0)
    again(queue, wire)
    assert wire.frames == 1 and wire.errors


def test_a_timing_that_fits_is_the_wires() -> None:
    _, wire = well()
    port = wire.ports[1]
    port.timing = BitTiming(1005.0)
    assert port.timing is None
    port.timing = BitTiming(500.0)
    assert port.timing == BitTiming(500.0)
    port.timing = None
    assert port.timing is None


def test_a_filter_lets_through_what_it_says() -> None:
    queue, wire = well()
    log = listen(wire, 1)
    wire.ports[1].accept([(0x7F0, 0x12F), (0x7FF, 0x700)])
    for identifier in (0x120, 0x12F, 0x130, 0x700, 0x701):
        wire.ports[0].send(Frame(identifier, b""), queue.now_ns)
        queue.run_until(queue.now_ns + 1_000_000)
    assert [frame.identifier for _, frame in log] == [0x120, 0x12F, 0x700]
    wire.ports[1].accept(None)
    wire.ports[0].send(Frame(0x130, b""), queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    assert log[-1][1].identifier == 0x130


def test_who_is_off_hears_nothing_and_who_is_back_hears() -> None:
    queue, wire = network(3)
    log = listen(wire, 2)
    for online in (True, False, True):
        wire.ports[2].online = online
        wire.ports[0].send(FRAME, queue.now_ns)
        queue.run_until(queue.now_ns + 1_000_000)
    assert len(log) == 2


def test_who_goes_off_leaves_the_order_of_the_others() -> None:
    queue, wire = network(5)
    log = listen(wire, 4)
    wire.ports[0].send(FRAME, 0)
    for node, identifier in ((3, 1), (1, 5), (2, 2)):
        wire.ports[node].send(Frame(identifier, b""), 10_000)
    queue.run_until(50_500)
    wire.ports[3].online = False
    queue.run_until(1_000_000)
    assert [frame.identifier for _, frame in log] == [FRAME.identifier, 2, 5]


def test_a_frame_at_the_very_beginning_starts_there_though_somebody_goes_off() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    wire.ports[0].send(FRAME, 0)
    wire.ports[2].online = False
    queue.run_until(1_000_000)
    assert log == [(116_000, FRAME)]


def test_a_frame_is_withdrawn_from_its_own_buffer_until_it_begins() -> None:
    queue, wire = network(3)
    wire.disturb(lambda *_: None)  # every frame is decided when its first bit is over
    one, other = wire.ports[:2]
    late = Frame(0x300, b"")
    one.send(FRAME, 0)
    one.send(late, 0)
    queue.run_until(1000)
    assert not one.withdraw(FRAME)
    assert not one.withdraw(Frame(0x301, b"")) and not other.withdraw(late)
    assert one.free_buffers == 1
    assert one.withdraw(late) and one.free_buffers == 2
    queue.run_until(1_000_000)
    assert wire.frames == 1 and one.free_buffers == 3
