"""Bus-off recovery, bit by bit: 128 occurrences of eleven consecutive recessive bits (ISO 11898-1)."""

import pytest

from bus.can import Flip, Frame, Wire
from bus.can.bits import wire_bits
from bus.can.partition import Partition, move
from bus.can.port import BusError, Port
from bus.can.stuck import StuckDominant
from bus.time import EventQueue
from tests.bus.can.test_wire import listen, network

BIT_NS = 1000
RUNS_NS = 128 * 11 * BIT_NS
BAD_BIT = 50
FRAME = Frame(0x123, bytes.fromhex("0102030405060708"))
LENGTH = len(wire_bits(FRAME)) + 3
"""With intermission."""


def off_in_one(queue: EventQueue, wire: Wire, node: int = 0) -> int:
    """A node one error away from bus off sends a frame with one wrong bit; returns when the bus is recessive
    again: the wrong bit, an error flag of six bits, and then the error delimiter counts."""
    port = wire.ports[node]
    port.tec = 248
    starts: list[int] = []

    def wrong(t_ns: int, _frame: Frame, sender: str) -> Flip | None:
        if sender != port.name or starts:
            return None
        starts.append(t_ns)
        return Flip(BAD_BIT)

    wire.disturb(wrong)
    port.send(FRAME, queue.now_ns)
    while port.state != "bus_off":
        queue.run_until(queue.now_ns + BIT_NS)
    wire.disturb(None)
    return starts[0] + (BAD_BIT + 1 + 6) * BIT_NS


def back_ns(queue: EventQueue, port: Port, limit_ns: int = 10_000_000) -> int:
    """When `port` returns, to one nanosecond before and at."""
    while port.state == "bus_off":
        assert queue.now_ns < limit_ns
        queue.run_until(queue.now_ns + BIT_NS // 2)
    return queue.now_ns


def assert_back_at(queue: EventQueue, wire: Wire, due_ns: int) -> None:
    """The first node is back at this nanosecond and not one earlier."""
    queue.run_until(due_ns - 1)
    assert wire.ports[0].state == "bus_off"
    queue.run_until(due_ns)
    assert wire.ports[0].state == "active"


@pytest.mark.parametrize("start_ns", [0, 777_000])
def test_L1_on_a_quiet_bus_it_is_exactly_1408_bits(start_ns: int) -> None:
    queue, wire = network(2)
    queue.run_until(start_ns)
    wire.ports[0].rec = 40
    due = off_in_one(queue, wire) + RUNS_NS
    queue.run_until(due - 1)
    assert (wire.ports[0].state, wire.ports[0].rec) == ("bus_off", 40)
    queue.run_until(due)
    assert (wire.ports[0].state, wire.ports[0].tec, wire.ports[0].rec) == ("active", 0, 0)
    queue.run_until(due + LENGTH * BIT_NS)  # its frame was kept, and goes at once
    assert wire.frames == 1
    heard: list[Frame] = []
    wire.ports[0].on_receive = lambda _t, frame: heard.append(frame)
    wire.ports[1].send(Frame(7, b""), queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    assert heard == [Frame(7, b"")]


def test_L1_who_is_back_hears_what_was_routed_while_it_was_off() -> None:
    queue, wire = network(3)
    log = listen(wire, 0)
    due = off_in_one(queue, wire) + RUNS_NS
    wire.ports[1].send(Frame(7, b""), queue.now_ns)
    queue.run_until(due + 1_000_000)
    assert (wire.ports[0].state, log) == ("active", [])
    wire.ports[1].send(Frame(7, b""), queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    assert [frame for _, frame in log] == [Frame(7, b"")]


def test_L1_a_sound_bus_is_planned_again_once_the_last_is_back() -> None:
    """A frame that is offered to a planned bus has its end in the queue at once."""
    queue, wire = network(3)
    queue.run_until(off_in_one(queue, wire) + 2 * RUNS_NS)
    for node in (1, 2):  # what the error has cost is counted down
        wire.ports[node].rec = 0
    wire.ports[1].send(FRAME, queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    wire.ports[1].send(FRAME, queue.now_ns)
    assert queue.next_ns() == queue.now_ns + (LENGTH - 3) * BIT_NS


def test_L1_who_joins_during_a_frame_has_its_tail_for_a_first_run() -> None:
    queue, wire = network(5)
    off_in_one(queue, wire)
    piece = Partition(wire, [wire.ports[3], wire.ports[4]], queue.now_ns).piece
    queue.run_until(queue.now_ns + 500_000)
    sof = queue.now_ns
    piece.ports[0].send(FRAME, sof)
    queue.run_until(sof + 40 * BIT_NS)
    move(wire.ports[0], piece, queue.now_ns)
    tail = sof + (LENGTH - 11) * BIT_NS
    assert back_ns(queue, piece.ports[-1], tail + 2 * RUNS_NS) == tail + RUNS_NS


def test_L1_who_joins_takes_nothing_from_who_waits_already() -> None:
    queue, wire = network(5)
    first = off_in_one(queue, wire)
    other = Wire(queue)
    for port in (wire.ports[0], wire.ports[3]):
        move(port, other, queue.now_ns)
    waiting = other.ports[0]
    begun = queue.now_ns
    second = off_in_one(queue, wire)
    assert second > first
    queue.run_until(begun + 50 * 11 * BIT_NS)
    move(wire.ports[0], other, queue.now_ns)
    back = back_ns(queue, waiting, begun + 3 * RUNS_NS)
    assert RUNS_NS <= back - begun < RUNS_NS + 12 * BIT_NS


def test_L1_a_cut_is_mended_while_a_node_off_the_bus_has_a_frame_waiting() -> None:
    queue, wire = network(4)
    log = listen(wire, 1)
    due = off_in_one(queue, wire) + RUNS_NS
    cut = Partition(wire, [wire.ports[3]], queue.now_ns)
    queue.run_until(queue.now_ns + 300_000)
    cut.heal(queue.now_ns)
    wire.ports[3].send(Frame(7, b""), queue.now_ns)
    queue.run_until(due + 1_000_000)
    assert [frame for _, frame in log] == [Frame(7, b""), FRAME]


def test_L1_after_an_overload_frame_its_delimiter_and_intermission_are_the_first_run() -> None:
    """Ten runs, a frame whose last bit one receiver sees dominant: ACK delimiter and EOF are eight recessive
    bits and no run; the frame and its overload frame end with the next eleven."""
    queue, wire = network(4)
    quiet = off_in_one(queue, wire)
    sof = quiet + 10 * 11 * BIT_NS
    left = [Flip(LENGTH - 4, seen_by="n2")]
    wire.disturb(lambda *_: left.pop() if left else None)
    wire.ports[1].send(FRAME, sof)
    free = sof + (LENGTH + 6 + 1 + 8) * BIT_NS
    assert_back_at(queue, wire, free - 11 * BIT_NS + 118 * 11 * BIT_NS)


def test_L1_on_a_busy_bus_every_frame_is_one_run() -> None:
    """ACK delimiter, end of frame and intermission are eleven recessive bits, and so are the error delimiter
    and intermission behind the fatal error: 127 frames are left to wait for."""
    queue, wire = network(3)
    busy = wire.ports[1]
    off_in_one(queue, wire)
    busy.on_sent = lambda t_ns, _frame: busy.send(Frame(1, bytes(8)), t_ns)
    for _ in range(2):
        busy.send(Frame(1, bytes(8)), queue.now_ns)
    back_ns(queue, wire.ports[0], 20_000_000)
    assert wire.frames == 127


def test_L1_a_frame_in_between_costs_what_it_takes() -> None:
    """Ten runs and a half, then a frame: its dominant bits end the half run, its tail begins a new one."""
    queue, wire = network(2)
    quiet = off_in_one(queue, wire)
    wire.attach("third")
    sof = quiet + (10 * 11 + 5) * BIT_NS
    wire.ports[1].send(FRAME, sof)
    tail = sof + (LENGTH - 11) * BIT_NS
    due = tail + (128 - 10) * 11 * BIT_NS
    assert_back_at(queue, wire, due)


def test_L1_a_frame_under_way_at_the_end_of_the_wait_gives_the_last_run() -> None:
    queue, wire = network(2)
    quiet = off_in_one(queue, wire)
    wire.attach("third")
    sof = quiet + (127 * 11 + 5) * BIT_NS
    wire.ports[1].send(FRAME, sof)
    due = sof + LENGTH * BIT_NS  # its last eleven bits are the 128th run
    assert_back_at(queue, wire, due)


def test_L1_a_frame_cut_off_at_the_end_of_the_wait_delays_it_by_its_flags_only() -> None:
    queue, wire = network(4)
    quiet = off_in_one(queue, wire)
    sof = quiet + (127 * 11 + 5) * BIT_NS
    queue.run_until(sof - BIT_NS)
    wire.ports[1].send(FRAME, sof)
    queue.run_until(sof + 40 * BIT_NS)
    wire.ports[1].online = False
    assert back_ns(queue, wire.ports[0]) == sof + (40 + 6 + 6 + 11) * BIT_NS


def test_L1_a_node_that_joins_between_two_runs_waits_exactly_128() -> None:
    queue, wire = network(4)
    queue.run_until(21_500_000)
    off_in_one(queue, wire)
    since = 2000 * 11 * BIT_NS
    queue.run_until(since)
    port = wire.ports[0]
    Partition(wire, [port, wire.ports[3]], since)  # the new piece has been silent for 2000 whole runs
    assert port.state == "bus_off"
    assert back_ns(queue, port, since + 2 * RUNS_NS) == since + RUNS_NS


@pytest.mark.parametrize("idle_ns", [3_000_000, 20_000_003])
def test_L1_on_another_wire_the_count_begins_with_its_first_run(idle_ns: int) -> None:
    """A cable breaks and is mended; neither wire's silence before counts, and less than a run is lost."""
    queue, wire = network(4)
    queue.run_until(idle_ns)
    off_in_one(queue, wire)
    for act in ("cut", "mend"):
        queue.run_until(queue.now_ns + 100_000)
        if act == "cut":
            cut = Partition(wire, [wire.ports[0], wire.ports[3]], queue.now_ns)
        else:
            queue.run_until(queue.now_ns + 500_000)
            cut.heal(queue.now_ns)
        assert wire.ports[0].state == ("bus_off" if act == "mend" else "active")
        since = queue.now_ns
    back = back_ns(queue, wire.ports[0], since + 2 * RUNS_NS)
    assert RUNS_NS <= back - since < RUNS_NS + 12 * BIT_NS


def test_L1_in_a_piece_of_the_bus_it_takes_as_long() -> None:
    queue, wire = network(4)
    queue.run_until(20_000_000)
    off_in_one(queue, wire)
    port, partner = wire.ports[0], wire.ports[3]
    queue.run_until(queue.now_ns + 100_000)
    since = queue.now_ns
    Partition(wire, [port, partner], since)
    heard: list[Frame] = []
    port.on_receive = lambda _t, frame: heard.append(frame)
    back = back_ns(queue, port, since + 2 * RUNS_NS)
    assert RUNS_NS <= back - since < RUNS_NS + 12 * BIT_NS
    queue.run_until(back + 1_000_000)
    partner.send(Frame(7, b""), queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    assert heard == [Frame(7, b"")]  # it hears again, too


def test_L1_two_nodes_off_come_back_one_after_the_other() -> None:
    queue, wire = network(3)
    first = off_in_one(queue, wire)
    queue.run_until(first + 40 * 11 * BIT_NS)
    second = off_in_one(queue, wire, 1)
    assert second > first + 40 * 11 * BIT_NS
    back = [back_ns(queue, wire.ports[0]), back_ns(queue, wire.ports[1])]
    # 40 of the first one's runs lie before the second one's flag; then its frame, which was kept, delays
    # the second one by its bits but for its recessive tail.
    assert back[0] == second + 88 * 11 * BIT_NS
    assert back[1] == second + RUNS_NS + (LENGTH - 11) * BIT_NS


def test_L1_a_node_switched_while_off_starts_anew_and_leaves_the_other_one_waiting() -> None:
    queue, wire = network(3)
    off_in_one(queue, wire)
    second = off_in_one(queue, wire, 1)
    queue.run_until(second + 5 * 11 * BIT_NS)
    port = wire.ports[0]
    port.online = False
    port.online = True
    assert (port.state, port.tec) == ("active", 0)
    port.tec = 100
    queue.run_until(second + 127 * 11 * BIT_NS)
    assert (port.tec, wire.ports[1].state) == (100, "bus_off")  # no recovery takes its counter back
    assert back_ns(queue, wire.ports[1]) == second + RUNS_NS


def test_L1_dominant_bits_do_not_count_and_what_counted_stays() -> None:
    queue, wire = network(2)
    quiet = off_in_one(queue, wire)
    held = quiet + (20 * 11 + 3) * BIT_NS
    queue.run_until(held)
    stuck = StuckDominant(wire, held)
    queue.run_until(held + 5_000_000)
    assert wire.ports[0].state == "bus_off"
    stuck.release(queue.now_ns)
    due = queue.now_ns + 108 * 11 * BIT_NS
    assert_back_at(queue, wire, due)


def test_L1_a_sender_cut_off_costs_its_flag_and_no_run() -> None:
    """Six recessive bits after the cut, then the others' flag of six; the delimiter behind it counts."""
    queue, wire = network(4)
    quiet = off_in_one(queue, wire)
    sof = quiet + 10 * 11 * BIT_NS
    queue.run_until(sof - BIT_NS)
    wire.ports[1].send(FRAME, sof)
    queue.run_until(sof + 40 * BIT_NS)
    wire.ports[1].online = False
    again = sof + (40 + 6 + 6) * BIT_NS
    assert back_ns(queue, wire.ports[0]) == again + 118 * 11 * BIT_NS


def test_L1_who_comes_back_is_told_and_nobody_else() -> None:
    class Watcher:
        def __init__(self) -> None:
            self.times: list[int] = []

        def counted(self, t_ns: int) -> None:
            self.times.append(t_ns)

        def ignore(self, *_args: object, **_kinds: object) -> None:
            """Of no interest here."""

        began = lost = failed = activity = ignore

    queue, wire = network(3)
    due = off_in_one(queue, wire) + RUNS_NS
    watchers, told = [Watcher(), Watcher()], []
    for node, watcher in enumerate(watchers):
        port = wire.ports[node]
        port.watcher = watcher

        def note(t_ns: int, error: BusError, name: str = port.name) -> None:
            told.append((t_ns, error.kind, name))

        port.on_error = note
    queue.run_until(due)
    assert told == [(due, "", "n0")]
    assert (watchers[0].times, watchers[1].times) == ([due], [])


def test_L1_the_bit_rate_is_the_wires() -> None:
    queue, wire = network(2, 125_000)
    port = wire.ports[0]
    port.tec = 248
    wire.disturb(lambda *_: Flip(BAD_BIT))
    port.send(FRAME, 0)
    while port.state != "bus_off":
        queue.run_until(queue.now_ns + 1000)
    wire.disturb(None)
    due = (BAD_BIT + 1 + 6 + 128 * 11) * 8000
    queue.run_until(due - 1)
    assert port.state == "bus_off"
    queue.run_until(due)
    assert port.state == "active"
