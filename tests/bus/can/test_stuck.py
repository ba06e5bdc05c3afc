"""A bus held dominant, counted in bits by ISO 11898-1; a bus in two pieces."""

from hypothesis import given
from hypothesis import strategies as st

from bus.can import Frame, Wire
from bus.can.partition import Partition
from bus.can.stuck import StuckDominant
from bus.time import EventQueue

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
