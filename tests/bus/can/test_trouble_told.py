"""Trouble to the bit: who is told, who counts, what it costs, and that a sound bus is planned again."""

import pytest

from bus.can import Flip, Frame, Wire
from bus.can.bits import wire_bits
from bus.can.disturbance import seen_by_all, seen_by_receiver
from bus.can.length import frame_bits
from bus.can.port import BusError, Port
from bus.can.sampling import BitTiming
from bus.can.stuck import StuckDominant
from bus.time import EventQueue
from tests.bus.can.test_trouble import Told
from tests.bus.can.test_wire import listen, network

FRAME = Frame(0x123, bytes.fromhex("0102030405060708"))
LENGTH = len(wire_bits(FRAME))
ERROR_BITS, IFS_BITS, OVERLOAD_BITS = 6 + 8, 3, 6 + 1 + 8
"""Error flag and delimiter; intermission; one receiver's overload flag, the others' last bit, delimiter."""
LATE = Frame(0x700, b"\x55")


def heard(port: Port) -> list[BusError]:
    told: list[BusError] = []
    port.on_error = lambda _t, error: told.append(error)
    return told


def planned(queue: EventQueue, wire: Wire, sender: int = 0) -> bool:
    """Whether a frame of a sound bus costs one event: its end stands in the queue when it is offered."""
    queue.run_until(queue.now_ns + 10_000_000)
    start = queue.now_ns + 1000
    wire.ports[sender].send(FRAME, start)
    found = queue.next_ns() == start + LENGTH * 1000
    queue.run_until(start + 10_000_000)
    return found


def once(wire: Wire, *flips: Flip) -> None:
    left = list(flips)
    wire.disturb(lambda *_: left.pop(0) if left else None)


def test_a_sound_bus_is_planned_and_one_in_trouble_is_not() -> None:
    queue, wire = network(3)
    assert planned(queue, wire)
    wire.disturb(lambda *_: None)
    assert not planned(queue, wire)
    wire.disturb(None)
    assert planned(queue, wire)
    wire.ports[2].rec = 1
    wire.ports[1].online = False  # a change: it looks again
    assert not planned(queue, wire)  # the frame takes REC back to 0
    assert planned(queue, wire)


def test_after_a_stuck_bus_and_bus_off_it_is_planned_again() -> None:
    queue, wire = network(3)
    wire.ports[0].send(FRAME, 0)
    queue.run_until(50_000)
    stuck = StuckDominant(wire, 50_000)
    queue.run_until(1_000_000)
    stuck.release(1_000_000)
    queue.run_until(10_000_000)
    for _ in range(200):  # receivers ended passive: good frames take REC down
        wire.ports[0].send(FRAME, queue.now_ns)
        wire.ports[1].send(FRAME, queue.now_ns + 500_000)
        queue.run_until(queue.now_ns + 1_000_000)
    assert planned(queue, wire)


def test_a_node_alone_because_the_other_is_off_gets_no_acknowledge() -> None:
    queue, wire = network(2)
    wire.ports[1].online = False
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert (wire.frames, wire.errors["ack"] > 5) == (0, True)


@pytest.mark.parametrize("late_bits", [1, 2])
def test_who_is_ready_at_the_end_of_the_first_bit_takes_part(late_bits: int) -> None:
    queue, wire = network(3)
    wire.disturb(lambda *_: None)
    log = listen(wire, 2)
    wire.ports[0].send(LATE, 10_000)
    wire.ports[1].send(FRAME, 10_000 + late_bits * 1000)
    queue.run_until(1_000_000)
    assert [frame for _, frame in log] == ([FRAME, LATE] if late_bits == 1 else [LATE, FRAME])


@pytest.mark.parametrize("calm", [True, False])
def test_a_frame_that_comes_during_an_error_frame_waits_its_turn(calm: bool) -> None:
    queue, wire = network(3)
    log = listen(wire, 2)
    once(wire, Flip(50))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(55_000)  # in the error flag
    if calm:
        wire.disturb(None)
    wire.ports[1].send(LATE, 55_000)
    queue.run_until(1_000_000)
    begin = 51 + ERROR_BITS + IFS_BITS
    assert log == [
        ((begin + LENGTH) * 1000, FRAME),
        ((begin + LENGTH + IFS_BITS + len(wire_bits(LATE))) * 1000, LATE),
    ]
    assert [(port.tec, port.rec) for port in wire.ports] == [(7, 0), (0, 0), (0, 0)]
    assert wire.errors == {"bit": 1}


def test_a_passive_loser_counts_waits_and_is_told() -> None:
    """Same identifier, other data: it adds 8, misses nothing, and sends after the winner and eight bits."""
    queue, wire = network(3)
    log, told = listen(wire, 2), heard(wire.ports[0])
    lost, won = Frame(0x123, b"\xff" * 8), Frame(0x123, bytes(8))
    wire.ports[0].tec = 130
    wire.disturb(lambda *_: None)  # makes the wire look at the counters
    wire.ports[0].send(lost, 0)
    wire.ports[1].send(won, 0)
    end = (frame_bits(won) - IFS_BITS) * 1000
    queue.run_until(end)
    assert wire.errors == {"bit": 1}
    assert [(port.tec, port.rec) for port in wire.ports] == [(138, 0), (0, 0), (0, 0)]
    assert told[0] == BusError("bit", True)
    queue.run_until(1_000_000)
    again = (frame_bits(won) + 8 + frame_bits(lost) - IFS_BITS) * 1000
    assert log == [(end, won), (again, lost)]
    assert wire.ports[0].tec == 137


def test_neither_sender_of_the_very_same_frame_hears_it() -> None:
    queue, wire = network(4)
    logs = [listen(wire, node) for node in range(4)]
    wire.disturb(lambda *_: None)
    wire.ports[0].rec = wire.ports[1].rec = 3
    for port in wire.ports[:2]:
        port.send(FRAME, 0)
    queue.run_until(1_000_000)
    assert [len(log) for log in logs] == [0, 0, 1, 1]
    assert [port.rec for port in wire.ports] == [3, 3, 0, 0]
    assert all(port.free_buffers == 3 for port in wire.ports)


@pytest.mark.parametrize("node", [0, 1])
@pytest.mark.parametrize("gone", ["off", "detached"])
def test_one_of_two_senders_of_the_very_same_frame_goes_and_nobody_notices(node: int, gone: str) -> None:
    """The other's bits are the same: a dominant bit less on a wired AND changes nothing."""
    queue, wire = network(4)
    log = listen(wire, 2)
    done: list[str] = []
    for port in wire.ports[:2]:
        port.on_sent = lambda _t, _f, name=port.name: done.append(name)  # type: ignore[misc]
        port.send(FRAME, 0)
    queue.run_until(40_000)
    port, other = wire.ports[node], wire.ports[1 - node]
    if gone == "off":
        port.online = False
    else:
        wire.detach(port)
    queue.run_until(1_000_000)
    assert log == [(LENGTH * 1000, FRAME)]
    assert (wire.errors, wire.frames, done) == ({}, 1, [other.name])
    assert (other.free_buffers, other.tec, wire.ports[-1].rec) == (3, 0, 0)
    other.send(LATE, queue.now_ns)
    queue.run_until(2_000_000)
    assert log[-1][1] == LATE


def test_a_passive_receiver_that_misses_a_frame_is_told_of_its_error() -> None:
    queue, wire = network(3)
    wire.ports[2].rec = 130
    told = heard(wire.ports[2])
    once(wire, Flip(60, seen_by="n2"))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(LENGTH * 1000 - 1)
    assert told == [BusError("crc")]


def test_a_bit_at_somebody_who_is_not_here_changes_nothing() -> None:
    times = []
    for flip in (Flip(200), Flip(LENGTH - 1, seen_by="nobody"), Flip(50, seen_by="nobody")):
        queue, wire = network(3)
        log = listen(wire, 1)
        once(wire, flip)
        wire.ports[0].send(FRAME, 0)
        wire.ports[0].send(FRAME, 0)
        queue.run_until(1_000_000)
        times.append([t for t, _ in log])
        assert (wire.errors, wire.bits) == ({}, 2 * (LENGTH + IFS_BITS))
    assert times == [[LENGTH * 1000, (2 * LENGTH + IFS_BITS) * 1000]] * 3


def test_a_stranger_destroys_frames_until_it_is_passive_and_is_deaf_then() -> None:
    """It samples twice a bit, so three dominant bits in a row are a stuff error to it. Each time it was the
    first: 1 and 8 for it, 1 for the others, 8 for the sender; beyond 127, after fifteen, it harms nobody."""
    queue, wire = network(3)
    log, deaf = listen(wire, 1), listen(wire, 2)
    told = heard(wire.ports[2])
    watcher = Told()
    wire.ports[2].watcher = watcher
    wire.ports[2].timing = BitTiming(500)
    wire.ports[0].send(Frame(0x123, bytes(8)), 0)
    while wire.errors != {"bit": 15, "stuff": 1}:
        assert queue.now_ns < 10_000_000
        queue.run_until(queue.now_ns + 1000)
    assert told[-1] == BusError("stuff")
    assert [port.rec for port in wire.ports] == [0, 15, 136]
    queue.run_until(queue.now_ns + 1_000_000)
    assert (len(log), deaf) == (1, [])
    assert [(port.tec, port.rec) for port in wire.ports] == [(119, 0), (0, 14), (0, 136)]
    assert wire.errors == {"bit": 15, "stuff": 1}
    assert told.count(BusError("bit")) == 15
    assert watcher.failures == [False] * 16


def test_after_a_good_frame_all_are_told_that_counters_changed() -> None:
    queue, wire = network(3)
    told = [heard(port) for port in wire.ports]
    once(wire, Flip(50))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert told == [
        [BusError("bit", True), BusError("")],
        [BusError("bit"), BusError("")],
        [BusError("bit"), BusError("")],
    ]


@pytest.mark.parametrize("overload", [True, False])
def test_a_cut_frame_counts_the_bits_it_had(overload: bool) -> None:
    queue, wire = network(3)
    once(wire, *([Flip(LENGTH - 1, seen_by="n2")] if overload else []))
    wire.ports[0].send(FRAME, 7_000)
    queue.run_until(47_000)
    wire.ports[0].online = False
    assert wire.bits == 40 + 6 + ERROR_BITS + IFS_BITS
    assert [port.rec for port in wire.ports] == [0, 1, 1]
    queue.run_until(1_000_000)
    wire.ports[1].send(LATE, queue.now_ns)
    queue.run_until(2_000_000)
    assert wire.bits == 40 + 6 + ERROR_BITS + IFS_BITS + frame_bits(LATE)


def test_an_overload_frame_counts_its_bits_and_delays_the_next() -> None:
    queue, wire = network(3)
    once(wire, Flip(LENGTH - 1, seen_by="n2"))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert wire.bits == LENGTH + IFS_BITS + OVERLOAD_BITS
    wire.ports[0].send(FRAME, queue.now_ns)
    queue.run_until(2_000_000)
    assert wire.bits == 2 * (LENGTH + IFS_BITS) + OVERLOAD_BITS


def test_a_bus_held_dominant_before_a_frame_begins_takes_nothing_from_its_sender() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    wire.ports[0].send(FRAME, 100_000)
    queue.run_until(50_000)
    stuck = StuckDominant(wire, 50_000)
    queue.run_until(70_000)
    stuck.release(70_000)
    queue.run_until(1_000_000)
    assert log == [(100_000 + LENGTH * 1000, FRAME)]
    assert [port.tec for port in wire.ports] == [0, 0, 0]
    assert wire.ports[0].rec == wire.ports[1].rec + 1 > 1  # the good frame took one off the other
    assert wire.bits == LENGTH + IFS_BITS


def test_a_bus_held_dominant_counts_the_bits_that_were_through() -> None:
    queue, wire = network(3)
    wire.ports[0].send(FRAME, 7_000)
    queue.run_until(57_000)
    StuckDominant(wire, 57_000)
    assert wire.bits == 50


class Diary:
    """A watcher that keeps what it is told, and when."""

    def __init__(self) -> None:
        self.told: list[tuple[int, str]] = []

    def began(self, t_ns: int) -> None:
        self.told.append((t_ns, "began"))

    def lost(self, t_ns: int) -> None:
        self.told.append((t_ns, "lost"))

    def activity(self, t_ns: int) -> None:
        self.told.append((t_ns, "activity"))

    def counted(self, t_ns: int) -> None:
        self.told.append((t_ns, "counted"))

    def failed(self, t_ns: int, *, sending: bool) -> None:
        self.told.append((t_ns, f"failed {sending}"))


def diaries(wire: Wire) -> list[Diary]:
    found = [Diary() for _ in wire.ports]
    for port, diary in zip(wire.ports, found, strict=True):
        port.watcher = diary
    return found


def test_who_begins_who_loses_and_who_wakes_is_told_when_the_first_bit_is_over() -> None:
    queue, wire = network(4)
    first, second, sleeper, other = diaries(wire)
    wire.ports[2].asleep = True
    wire.ports[0].send(FRAME, 10_000)
    wire.ports[1].send(LATE, 10_000)
    queue.run_until(20_000)
    assert [each.told for each in (first, second, sleeper, other)] == [
        [(11_000, "began")], [(11_000, "lost")], [(11_000, "activity")], [],
    ]  # fmt: skip
    queue.run_until(10_000 + LENGTH * 1000)
    assert first.told[1:] == other.told == [(10_000 + LENGTH * 1000, "counted")]
    assert sleeper.told[1:] == []  # it misses what woke it


def test_both_senders_of_the_very_same_frame_are_told_that_it_begins() -> None:
    queue, wire = network(3)
    first, second, other = diaries(wire)
    for port in wire.ports[:2]:
        port.send(FRAME, 10_000)
    queue.run_until(20_000)
    assert first.told == second.told == [(11_000, "began")]
    assert other.told == []


def test_an_error_frame_is_told_at_the_end_of_its_delimiter() -> None:
    queue, wire = network(3)
    found = diaries(wire)
    once(wire, Flip(50))
    wire.ports[0].send(FRAME, 0)
    end = (51 + ERROR_BITS) * 1000
    queue.run_until(end)
    assert [each.told[-1] for each in found] == [
        (end, "failed True"),
        (end, "failed False"),
        (end, "failed False"),
    ]


def test_a_planned_frame_that_is_cut_counts_the_bits_it_had() -> None:
    queue, wire = network(3)
    wire.ports[0].send(FRAME, 7_000)
    queue.run_until(47_000)
    wire.ports[0].online = False
    assert wire.bits == 40 + 6 + ERROR_BITS + IFS_BITS


def test_a_look_at_a_sound_bus_leaves_its_plan() -> None:
    queue, wire = network(3)
    queue.run_until(10_000)
    wire.ports[0].send(FRAME, 10_000)
    wire.disturb(None)
    assert queue.next_ns() == 10_000 + LENGTH * 1000


@pytest.mark.parametrize("silent", [True, False])
def test_who_cannot_object_is_told_and_misses_the_frame(silent: bool) -> None:
    queue, wire = network(3)
    log, missed = listen(wire, 1), listen(wire, 2)
    watcher, told = Told(), heard(wire.ports[2])
    wire.ports[2].watcher = watcher
    wire.ports[2].listen_only, wire.ports[2].rec = silent, 0 if silent else 128
    once(wire, Flip(50, seen_by="n2"))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    verdict = seen_by_receiver(FRAME, 50)
    assert verdict is not None and wire.errors == {verdict.kind: 1}
    assert (len(log), missed, watcher.failures) == (1, [], [False])
    assert told[0] == BusError(verdict.kind)
    assert wire.ports[2].rec == (0 if silent else 129)


@pytest.mark.parametrize(("seen_by", "flags"), [(None, 6), ("n2", 12)])
def test_an_error_frame_counts_its_bits(seen_by: str | None, flags: int) -> None:
    """Up to the bit in which it is seen, one flag or one that is answered, delimiter, intermission."""
    queue, wire = network(3)
    once(wire, Flip(50, seen_by))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    verdict = seen_by_receiver(FRAME, 50) if seen_by else seen_by_all(FRAME, 50)
    assert verdict is not None
    ended = verdict.detected_bit + 1 + flags + 8 + IFS_BITS
    assert wire.bits == ended + LENGTH + IFS_BITS


def test_an_overload_or_a_cut_leaves_nothing_behind() -> None:
    """Each time the next frame, planned on a sound bus, is cut after forty bits."""
    queue, wire = network(3)
    once(wire, Flip(LENGTH - 1, seen_by="n2"))
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    wire.disturb(None)
    for _ in range(2):
        before, start = wire.bits, queue.now_ns
        wire.ports[0].send(FRAME, start)
        queue.run_until(start + 40_000)
        wire.ports[0].online = False
        assert wire.bits - before == 40 + 6 + ERROR_BITS + IFS_BITS
        wire.ports[0].online = True
        for port in wire.ports:
            port.tec = port.rec = 0
        wire.disturb(None)  # a look: the bus is sound
        queue.run_until(start + 1_000_000)


def test_a_cut_is_told_and_counts_once() -> None:
    queue, wire = network(3)
    told = heard(wire.ports[1])
    wire.ports[0].send(FRAME, 0)
    queue.run_until(40_000)
    wire.ports[0].online = False
    wire.ports[0].online = True
    assert wire.errors == {"stuff": 1} and told == [BusError("stuff")]
