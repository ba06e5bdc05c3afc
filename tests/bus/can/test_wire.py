import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bus.can import Frame, Wire
from bus.can.length import frame_bits
from bus.can.wire import BitrateError
from bus.time import EventQueue

Log = list[tuple[int, Frame]]


def network(nodes: int, bitrate: int = 1_000_000) -> tuple[EventQueue, Wire]:
    queue = EventQueue()
    wire = Wire(queue, bitrate)
    for number in range(nodes):
        wire.attach(f"n{number}")
    return queue, wire


def listen(wire: Wire, node: int) -> Log:
    log: Log = []
    wire.ports[node].on_receive = lambda t_ns, frame: log.append((t_ns, frame))
    return log


@pytest.mark.parametrize(("bitrate", "bit_ns"), [(1_000_000, 1000), (250_000, 4000), (125_000, 8000)])
def test_L1_a_frame_takes_its_bits(bitrate: int, bit_ns: int) -> None:
    queue, wire = network(2, bitrate)
    log = listen(wire, 1)
    frame = Frame(0x123, bytes.fromhex("0102030405060708"))
    wire.ports[0].send(frame, 500)
    queue.run_until(10_000_000)
    # 119 bits with intermission (hardware.md 3.3); delivery is at the end of EOF, three bits before.
    assert log == [(500 + 116 * bit_ns, frame)]
    assert (wire.frames, wire.bits) == (1, 119)
    assert wire.load == pytest.approx(119 * bit_ns / 10_000_000)


sends = st.lists(
    st.tuples(st.integers(0, 5), st.integers(0, 400_000), st.integers(0, 0x7FF), st.binary(max_size=8)),
    max_size=18,
    unique_by=lambda send: send[2],
)


@given(sends)
@example([(0, 0, 15, b""), (0, 49_001, 0, b"")])  # ready in the first bit after the bus fell free
def test_L1_arbitration_order(batch: list[tuple[int, int, int, bytes]]) -> None:
    """Every frame once, never two at a time; each winner is the lowest of those ready in its first bit."""
    queue, wire = network(7)
    wire.ports[6].on_receive = lambda *_: None
    ends: list[tuple[int, Frame]] = []
    wire.tap(lambda t_ns, frame, _: ends.append((t_ns, frame)))
    ready: dict[int, int] = {}
    for node, t_ns, identifier, data in batch:
        frame = Frame(identifier, data)
        if wire.ports[node].send(frame, t_ns):
            ready[identifier] = t_ns
    queue.run_until(10_000_000)
    assert sorted(frame.identifier for _, frame in ends) == sorted(ready)
    free = 0
    left = dict(ready)
    for end, frame in ends:
        start = end - (frame_bits(frame) - 3) * 1000
        assert start == max(free, min(left.values()))
        in_first_bit = [identifier for identifier, t_ns in left.items() if t_ns <= start + 1000]
        assert frame.identifier == min(in_first_bit)
        del left[frame.identifier]
        free = end + 3000


def test_L1_three_transmit_buffers() -> None:
    queue, wire = network(2)
    port = wire.ports[0]
    assert [port.send(Frame(i, b""), 0) for i in range(4)] == [True, True, True, False]
    sent: list[int] = []
    port.on_sent = lambda _, frame: sent.append(frame.identifier)
    queue.run_until(1_000_000)
    assert sent == [0, 1, 2]
    assert port.send(Frame(9, b""), queue.now_ns)


def test_L1_within_a_node_equal_identifiers_keep_their_order() -> None:
    queue, wire = network(2)
    log = listen(wire, 1)
    for number in range(3):
        wire.ports[0].send(Frame(5, bytes([number])), 0)
    queue.run_until(1_000_000)
    assert [frame.data[0] for _, frame in log] == [0, 1, 2]


@given(st.lists(st.tuples(st.integers(0, 0x7FF), st.integers(0, 0x7FF)), max_size=4), st.integers(0, 0x7FF))
def test_L1_acceptance_filters(filters: list[tuple[int, int]], identifier: int) -> None:
    queue, wire = network(2)
    log = listen(wire, 1)
    wire.ports[1].accept(filters)
    wire.ports[0].send(Frame(identifier, b""), 0)
    queue.run_until(1_000_000)
    assert bool(log) == any(identifier & mask == code & mask for mask, code in filters)
    assert wire.frames == 1, "a frame nobody wants is acknowledged all the same"


def test_L1_filters_may_change_at_any_time() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    for filters in ([], None, [(0x7FF, 6)], [(0x7FF, 5)]):
        wire.ports[1].accept(filters)
        wire.ports[0].send(Frame(5, b""), queue.now_ns)
        queue.run_until(queue.now_ns + 1_000_000)
    assert len(log) == 2


def test_L1_a_node_does_not_hear_itself_and_remote_frames_carry_no_data() -> None:
    queue, wire = network(2)
    own, other = listen(wire, 0), listen(wire, 1)
    wire.ports[0].send(Frame(5, bytes(8), remote=True), 0)
    queue.run_until(1_000_000)
    assert not own
    assert (
        other[0][0]
        == (frame_bits(Frame(5, b"")) - 3 + (frame_bits(other[0][1]) - frame_bits(Frame(5, b"")))) * 1000
    )
    assert wire.bits < 60


def test_L1_a_node_that_is_off_is_not_there() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    off = wire.ports[1]
    off.send(Frame(1, b""), 0)
    off.online = False
    assert not off.send(Frame(1, b""), 0)
    wire.ports[0].send(Frame(2, b""), 0)
    queue.run_until(1_000_000)
    assert (log, wire.frames) == ([], 1)
    off.online = True
    assert off.send(Frame(3, b""), queue.now_ns)
    wire.ports[0].send(Frame(4, b""), queue.now_ns)
    queue.run_until(2_000_000)
    assert [frame.identifier for _, frame in log] == [4]


@pytest.mark.parametrize("bitrate", [0, -5, 1_000_001])
def test_L1_bit_rates_can_does_not_have(bitrate: int) -> None:
    with pytest.raises(BitrateError, match=str(bitrate)):
        Wire(EventQueue(), bitrate)


def test_a_bit_is_a_whole_number_of_nanoseconds_down_to_one_bit_a_second() -> None:
    assert [Wire(EventQueue(), rate).bit_ns for rate in (1, 300_000, 1_000_000)] == [10**9, 3333, 1000]


def test_before_anything_has_happened_the_load_is_nothing() -> None:
    assert Wire(EventQueue()).load == 0.0


def test_who_is_detached_is_gone_and_the_bus_sound_again() -> None:
    queue, wire = network(2)
    guest = wire.attach("guest")
    guest.listen_only = True
    wire.detach(guest)
    wire.detach(guest)
    assert [port.name for port in wire.ports] == ["n0", "n1"]
    wire.ports[0].send(Frame(1, b""), 1000)
    assert queue.next_ns() == 1000 + (frame_bits(Frame(1, b"")) - 3) * 1000  # the end of EOF, told in advance


def test_a_tap_hears_until_it_is_taken_off() -> None:
    queue, wire = network(2)
    heard: list[str] = []

    def tap(_t_ns: int, _frame: Frame, sender: str) -> None:
        heard.append(sender)

    wire.tap(tap)
    for node in (0, 1):
        wire.ports[node].send(Frame(1, b""), queue.now_ns)
        queue.run_until(queue.now_ns + 1_000_000)
        if node == 0:
            wire.untap(tap)
    assert heard == ["n0"]


def test_a_disturbance_that_is_set_is_asked() -> None:
    queue, wire = network(2)
    asked: list[int] = []

    def ask(sof_ns: int, _frame: Frame, _sender: str) -> None:
        asked.append(sof_ns)

    wire.disturbance = ask
    assert wire.disturbance is ask
    wire.ports[0].send(Frame(1, b""), 5000)
    queue.run_until(1_000_000)
    assert asked == [5000]


@pytest.mark.parametrize("senders", [(1, 2), (1, 1)])
def test_what_waits_on_a_sound_bus_is_planned_as_the_bus_falls_free(senders: tuple[int, int]) -> None:
    """Of two nodes, or of one with the same identifier twice: no arbitration is to be decided."""
    queue, wire = network(4)
    first = Frame(0x123, bytes(8))
    wire.ports[0].send(first, 0)
    waiting = [
        Frame(0x200 + (node if senders == (1, 2) else 0), bytes([k])) for k, node in enumerate(senders)
    ]
    for node, frame in zip(senders, waiting, strict=True):
        wire.ports[node].send(frame, 10_000)
    free_ns = frame_bits(first) * 1000
    queue.run_until(free_ns - 3000)
    assert queue.next_ns() == free_ns + (frame_bits(waiting[0]) - 3) * 1000
