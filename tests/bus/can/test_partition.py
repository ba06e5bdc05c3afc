"""Nodes that lose the cable and come back: what they send, what they hear, and what the others see."""

from bus.can import Frame
from bus.can.bits import wire_bits
from bus.can.partition import Partition, move
from tests.bus.can.test_wire import listen, network

BIT_NS = 1000
LONG = Frame(0x123, bytes.fromhex("0102030405060708"))
END_NS = len(wire_bits(LONG)) * BIT_NS
"""From the start of frame to the end of EOF, where it is delivered."""


def test_a_frame_that_waits_goes_out_on_the_new_bus_and_the_other_goes_on() -> None:
    queue, wire = network(4)
    there, here = listen(wire, 2), listen(wire, 3)
    waiting = Frame(0x200, b"\x01")
    wire.ports[0].send(LONG, 0)
    wire.ports[1].send(waiting, 0)
    queue.run_until(50_500)
    Partition(wire, [wire.ports[1], wire.ports[2]], 50_500)
    queue.run_until(1_000_000)
    assert here == [(END_NS, LONG)]
    assert there == [(50_500 + len(wire_bits(waiting)) * BIT_NS, waiting)]
    assert not wire.errors


def test_what_was_being_sent_is_cut_off_and_tried_again_before_what_was_loaded_later() -> None:
    queue, wire = network(4)
    there, here = listen(wire, 1), listen(wire, 3)
    second = Frame(LONG.identifier, b"\x02")
    wire.ports[0].send(LONG, 0)
    wire.ports[0].send(second, 0)
    queue.run_until(50_500)
    piece = Partition(wire, [wire.ports[0], wire.ports[1]], 50_500).piece
    queue.run_until(1_000_000)
    assert here == [] and wire.errors == {"stuff": 1}
    assert [port.rec for port in wire.ports] == [1, 1]
    assert [frame for _, frame in there] == [LONG, second] and there[0][0] == 50_500 + END_NS
    assert piece.frames == 2 and not piece.errors


def test_frames_of_one_identifier_keep_the_order_in_which_they_were_loaded() -> None:
    queue, wire = network(4)
    there = listen(wire, 2)
    wire.ports[0].send(LONG, 0)
    frames = [Frame(0x200, bytes([k])) for k in range(3)]
    for frame, ready_ns in zip(frames, (9000, 6000, 3000), strict=True):
        wire.ports[1].send(frame, ready_ns)
    queue.run_until(50_500)
    Partition(wire, [wire.ports[1], wire.ports[2]], 50_500)
    queue.run_until(1_000_000)
    assert [frame for _, frame in there] == frames


def test_who_stays_keeps_the_order_of_identifiers() -> None:
    queue, wire = network(5)
    log = listen(wire, 4)
    wire.ports[0].send(LONG, 0)
    for node, identifier in ((3, 1), (1, 5), (2, 2)):
        wire.ports[node].send(Frame(identifier, b""), 10_000)
    queue.run_until(50_500)
    Partition(wire, [wire.ports[3]], 50_500)
    queue.run_until(1_000_000)
    assert [frame.identifier for _, frame in log] == [LONG.identifier, 2, 5]


def test_a_frame_in_its_first_bit_is_sent_though_somebody_leaves() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    queue.run_until(10_000)
    wire.ports[0].send(LONG, 10_000)
    queue.run_until(10_500)
    Partition(wire, [wire.ports[2]], 10_500)
    queue.run_until(1_000_000)
    assert log == [(10_000 + END_NS, LONG)]


def test_who_joins_in_the_first_bit_takes_part_in_the_arbitration() -> None:
    queue, wire = network(4)
    log = listen(wire, 1)
    cut = Partition(wire, [wire.ports[2], wire.ports[3]], 0)
    queue.run_until(10_000)
    wire.ports[0].send(LONG, 10_000)
    two = cut.piece.ports[0]
    strong = Frame(LONG.identifier - 1, b"")
    two.send(strong, 10_400)
    queue.run_until(10_500)
    move(two, wire, 10_500)
    queue.run_until(1_000_000)
    assert [frame for _, frame in log] == [strong, LONG]


def test_who_left_hears_nothing_more_and_who_is_back_hears_again() -> None:
    queue, wire = network(4)
    log = listen(wire, 3)
    heard: list[int] = []
    for t_ns in (0, 1_000_000, 2_000_000):  # the same identifier each time: who gets it is kept
        queue.run_until(t_ns)
        if t_ns == 1_000_000:
            cut = Partition(wire, [wire.ports[3]], t_ns)
        if t_ns == 2_000_000:
            cut.heal(t_ns)
        wire.ports[0].send(LONG, t_ns)
        queue.run_until(t_ns + 500_000)
        heard.append(len(log))
    assert heard == [1, 1, 2]
    assert [port.name for port in wire.ports] == ["n0", "n1", "n2", "n3"]


def test_a_node_left_alone_has_no_acknowledge() -> None:
    queue, wire = network(2)
    wire.ports[1].on_receive = lambda *_: None
    Partition(wire, [wire.ports[1]], 0)
    wire.ports[0].send(LONG, 0)
    queue.run_until(150_000)
    assert wire.frames == 0 and wire.errors == {"ack": 1} and wire.ports[0].tec == 8


def test_a_node_brings_its_counters_and_they_go_down_where_it_is() -> None:
    queue, wire = network(4)
    cut = Partition(wire, [wire.ports[3]], 0)
    port = cut.piece.ports[0]
    port.tec = 8
    cut.heal(0)
    port.send(LONG, 0)
    queue.run_until(1_000_000)
    assert (wire.frames, port.tec) == (1, 7)


def test_a_tap_of_both_pieces_hears_them_until_they_are_joined() -> None:
    queue, wire = network(4)
    heard: list[int] = []
    cut = Partition(wire, wire.ports[2:], 0, lambda _t, frame, _sender: heard.append(frame.identifier))
    wire.ports[0].send(Frame(1, b""), 0)
    cut.piece.ports[0].send(Frame(2, b""), 1)
    queue.run_until(1_000_000)
    assert heard == [1, 2]
    cut.heal(1_000_000)
    for port in wire.ports:
        port.send(Frame(3, b""), 1_000_000)
    queue.run_until(2_000_000)
    assert heard == [1, 2] and wire.frames > 1
