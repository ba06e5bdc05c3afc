"""A bus held dominant, counted in bits by ISO 11898-1; a bus in two pieces."""

from hypothesis import given
from hypothesis import strategies as st

from bus.can import Frame, Wire
from bus.can.bits import wire_bits
from bus.can.partition import Partition
from bus.can.port import BusError
from bus.can.stuck import StuckDominant
from bus.time import EventQueue
from tests.bus.can.test_trouble_told import diaries, heard
from tests.bus.can.test_wire import listen, network

FRAME = Frame(0x123, b"\x00" * 8)


def test_receivers_count_by_the_standard_and_stay_on_the_bus() -> None:
    wire = Wire(EventQueue())
    port = wire.attach("one")
    wire.attach("two")
    wire.queue.run_until(10_000)
    StuckDominant(wire, 10_000)
    counts = []
    for bits in (5, 6, 12, 13, 20, 21, 29, 37, 1000):
        wire.queue.run_until(10_000 + bits * 1000)
        counts.append(port.rec)
    # stuff error at the 6th bit; the bit after the flag; then every 8 bits
    assert counts == [0, 1, 1, 9, 9, 17, 25, 33, 255]
    assert (port.state, port.tec) == ("passive", 0)


def test_the_sender_goes_off_the_bus_and_comes_back() -> None:
    wire = Wire(EventQueue())
    one, two = wire.attach("one"), wire.attach("two")
    heard: list[Frame] = []
    two.on_receive = lambda _t, frame: heard.append(frame)
    one.send(FRAME, 0)
    wire.queue.run_until(50_000)
    stuck = StuckDominant(wire, 50_000)
    wire.queue.run_until(400_000)
    assert one.state == "bus_off"
    stuck.release(400_000)
    wire.queue.run_until(400_000 + 127 * 11_000)
    assert (one.state, heard) == ("bus_off", [])
    wire.queue.run_until(400_000 + 140 * 11_000)
    assert (one.state, heard) == ("active", [FRAME])


def test_a_sender_held_dominant_counts_as_one_and_all_are_told() -> None:
    """TEC + 8 at the sixth bit, at the twenty-first, and every eight bits: beyond 255 after 32 times."""
    queue, wire = network(3)
    watched = diaries(wire)
    told = [heard(port) for port in wire.ports]
    wire.ports[0].send(FRAME, 0)
    queue.run_until(50_000)
    for each in watched:
        each.told.clear()
    StuckDominant(wire, 50_000)
    counts = []
    for bits in (5, 6, 20, 21, 29, 6 + 15 + 30 * 8 - 1, 6 + 15 + 30 * 8, 2000):
        queue.run_until(50_000 + bits * 1000)
        counts.append(wire.ports[0].tec)
    assert counts == [0, 8, 8, 16, 24, 248, 256, 256]
    assert wire.errors == {"bit": 1}
    assert told[0][0] == BusError("bit", True) and told[1][0] == BusError("bit", False)
    assert told[1][1:3] == [BusError(""), BusError("")]  # the bit after the flag, eight bits later
    assert watched[1].told[:3] == [(50_000 + bits * 1000, "counted") for bits in (6, 13, 21)]


def test_with_nobody_sending_it_is_a_stuff_error_and_ends_when_all_are_full() -> None:
    queue, wire = network(3)
    told = heard(wire.ports[0])
    wire.ports[2].online = False
    StuckDominant(wire, 0)
    queue.run_until(6000)
    assert wire.errors == {"stuff": 1} and told == [BusError("stuff", False)]
    queue.run_until(1_000_000)
    assert [port.rec for port in wire.ports] == [255, 255, 0]
    assert queue.next_ns() is None  # nothing is left to be counted


def test_a_sender_counts_on_though_its_receivers_are_full() -> None:
    queue, wire = network(2)
    wire.ports[0].send(FRAME, 0)
    queue.run_until(50_000)
    wire.ports[1].rec = 250
    StuckDominant(wire, 50_000)
    queue.run_until(50_000 + 300_000)
    assert wire.ports[0].state == "bus_off" and wire.ports[1].rec == 255


def test_a_frame_starts_a_delimiter_and_an_intermission_after_the_release() -> None:
    """Eight and three bits."""
    queue, wire = network(2)
    log = listen(wire, 1)
    stuck = StuckDominant(wire, 0)
    wire.ports[0].send(FRAME, 1000)
    queue.run_until(5000)
    stuck.release(5000)
    queue.run_until(1_000_000)
    assert log == [(5000 + 11_000 + len(wire_bits(FRAME)) * 1000, FRAME)]
    assert not wire.errors  # it was over before the sixth bit


@given(st.lists(st.integers(0, 1_500_000), min_size=2, max_size=2, unique=True), st.integers(1, 15))
def test_no_frame_is_lost_or_doubled_by_a_cut(cut: list[int], pieces: int) -> None:
    """Each of four nodes sends ten frames; wherever the cable breaks, none is sent twice."""
    wire = Wire(EventQueue())
    ports = [wire.attach(f"node {k}") for k in range(4)]
    sent: list[int] = []
    for k, port in enumerate(ports):
        port.on_sent = lambda _t, frame: sent.append(frame.identifier)
        for j in range(10):
            wire.queue.at(
                j * 150_000 + k * 7_000,
                lambda t, p=port, i=16 * k + j: p.send(Frame(0x100 + i, b"\x55" * 8), t),
            )
    start, end = sorted(cut)
    aside = [port for k, port in enumerate(ports) if pieces >> k & 1]
    wire.queue.run_until(start)
    partition = Partition(wire, aside, start)
    wire.queue.run_until(end)
    partition.heal(end)
    wire.queue.run_until(4_000_000_000)
    assert wire.ports == ports
    assert all(port.free_buffers == 3 for port in ports)
    assert len(sent) == len(set(sent))
    full = sum(len({frame for frame in sent if frame >> 4 == 0x10 + k}) for k in range(4))
    assert full >= 12  # at least the three buffers of each node; who had nobody to hear it had to drop some
