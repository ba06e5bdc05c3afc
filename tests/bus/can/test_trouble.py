"""Error confinement by ISO 11898-1 (hardware.md 3.3)."""

import itertools

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.can import Flip, Frame, Wire
from bus.can.bits import wire_bits
from bus.can.length import frame_bits
from bus.time import EventQueue
from tests.bus.can.test_wire import listen, network

FRAME = Frame(0x123, bytes.fromhex("0102030405060708"))
LENGTH = len(wire_bits(FRAME))


def once(flip: Flip):  # type: ignore[no-untyped-def]
    left = [flip]
    return lambda *_: left.pop() if left else None


def sent_through(wire: Wire, queue: EventQueue, flip: Flip) -> None:
    wire.disturb(once(flip))
    wire.ports[0].send(FRAME, queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)


def test_L1_a_lone_node_goes_passive_and_never_bus_off() -> None:
    queue, wire = network(1)
    port = wire.ports[0]
    port.send(FRAME, 0)
    queue.run_until(3_000_000)
    assert (port.tec, port.state) == (128, "passive")
    assert wire.errors["ack"] > 16
    queue.run_until(1_000_000_000)
    assert (port.tec, port.state, wire.frames) == (128, "passive", 0)
    wire.attach("late")
    queue.run_until(1_001_000_000)
    assert (wire.frames, port.tec, port.state) == (1, 127, "active")


@given(st.integers(0, LENGTH - 1))
def test_L1_every_flipped_bit_on_the_wire_is_an_error_and_the_frame_arrives_after_all(bit: int) -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    sent_through(wire, queue, Flip(bit))
    assert sum(wire.errors.values()) == 1
    # The last bit of EOF is the known double reception: receivers had the frame, the sender sends again.
    assert [frame for _, frame in log] == [FRAME] * (2 if bit == LENGTH - 1 else 1)
    assert wire.frames == 1


CRC_DELIMITER = LENGTH - 10
CASES = [
    (0, "bit"),  # SOF read recessive
    (CRC_DELIMITER - 20, "bit"),
    (CRC_DELIMITER, "form"),
    (CRC_DELIMITER + 1, "ack"),
    (CRC_DELIMITER + 2, "form"),
    (LENGTH - 3, "form"),
]


@pytest.mark.parametrize(("bit", "kind"), CASES)
def test_L1_where_the_bit_is_says_what_the_error_is(bit: int, kind: str) -> None:
    queue, wire = network(3)
    sent_through(wire, queue, Flip(bit))
    assert wire.errors == {kind: 1}
    # One error (+8) and one good frame (-1); receivers +1 and -1.
    assert [(port.tec, port.rec) for port in wire.ports] == [(7, 0), (0, 0), (0, 0)]


def test_L1_a_recessive_identifier_bit_overwritten_is_lost_arbitration_not_the_senders_error() -> None:
    queue, wire = network(2)
    wire.disturb(once(Flip(3)))  # 0x123 = 00100100011: bit 3 after SOF is the first recessive one
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert wire.errors == {"stuff": 1}
    assert [(port.tec, port.rec) for port in wire.ports] == [(0, 1), (0, 0)]


STUFFED = Frame(0x00F, b"stuff")
"""SOF and four dominant identifier bits: the sixth bit on the wire is a recessive stuff bit."""


def test_L1_a_recessive_stuff_bit_overwritten_in_arbitration_costs_the_sender_nothing() -> None:
    """ISO 11898-1, fault confinement, second exception of the rule that adds 8 to the transmit error count: a
    transmitter that sends an error flag because of a stuff error during arbitration, the stuff bit standing
    before RTR, sent recessive and monitored as dominant, leaves its count as it is. Receivers add 1."""
    assert wire_bits(STUFFED)[:7] == [0, 0, 0, 0, 0, 1, 0]
    queue, wire = network(3)
    left = [Flip(5), Flip(5)]
    wire.disturb(lambda *_: left.pop() if left else None)
    wire.ports[0].send(STUFFED, 0)
    queue.run_until(60_000)  # two error frames, no good one yet
    assert wire.errors == {"stuff": 2}
    assert [(port.tec, port.rec) for port in wire.ports] == [(0, 0), (0, 2), (0, 2)]


def test_L1_a_stuff_bit_behind_the_arbitration_field_is_the_transmitters_error() -> None:
    """The exception ends with the RTR bit: the first stuff bit of the data field is an ordinary bit error."""
    frame = Frame(0x7AA, bytes(2))
    bits = wire_bits(frame)
    stuffed = next(k for k in range(20, len(bits)) if bits[k] and not any(bits[k - 5 : k]))
    queue, wire = network(2)
    wire.disturb(once(Flip(stuffed)))
    wire.ports[0].send(frame, 0)
    queue.run_until(60_000)
    assert wire.ports[0].tec == 8


def test_L1_a_dominant_last_bit_of_eof_is_an_overload_condition_and_no_receive_error() -> None:
    """ISO 11898-1: the frame is valid for receivers when no error is seen up to the last but one bit of EOF,
    and a receiver that samples the last bit dominant begins an overload frame, which changes no counter. For
    the transmitter the same bit is an error (+8), so it sends the frame again."""
    queue, wire = network(3)
    log = listen(wire, 1)
    for port in wire.ports[1:]:
        port.rec = 5
    wire.disturb(once(Flip(LENGTH - 1)))
    wire.ports[0].send(FRAME, 0)
    queue.run_until((LENGTH + 6 + 8 + 3) * 1000)
    assert wire.errors == {"form": 1}
    assert [frame for _, frame in log] == [FRAME]
    assert [(port.tec, port.rec) for port in wire.ports] == [(8, 0), (0, 4), (0, 4)]
    queue.run_until(1_000_000)
    assert [frame for _, frame in log] == [FRAME, FRAME]
    assert [(port.tec, port.rec) for port in wire.ports] == [(7, 0), (0, 3), (0, 3)]


def test_L1_one_receivers_overload_flag_delays_the_bus_and_counts_nowhere() -> None:
    """ISO 11898-1: that receiver's flag begins in the first bit of intermission, which is an overload
    condition for all others; their flags end one bit later, then eight recessive bits and intermission."""
    times = []
    for flip in (None, Flip(LENGTH - 1, seen_by="n2")):
        queue, wire = network(3)
        log = listen(wire, 1)
        wire.disturb(once(flip) if flip else lambda *_: None)
        wire.ports[0].send(FRAME, 0)
        wire.ports[0].send(FRAME, 0)
        queue.run_until(1_000_000)
        assert [frame for _, frame in log] == [FRAME, FRAME]
        assert not wire.errors
        assert all(port.tec == port.rec == 0 for port in wire.ports)
        times.append([t for t, _ in log])
    plain, late = times
    assert late[0] == plain[0]
    assert late[1] - plain[1] == (6 + 1 + 8) * 1000


@given(st.integers(0, LENGTH - 2))
def test_L1_one_receivers_own_error_makes_everyone_repeat(bit: int) -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    sent_through(wire, queue, Flip(bit, seen_by="n2"))
    kinds = wire.errors
    assert [frame for _, frame in log] == [FRAME]
    if kinds:  # the flag of the first is answered: +1 and +8, then one good reception
        assert set(kinds) <= {"stuff", "crc", "form"}
        assert [(port.tec, port.rec) for port in wire.ports] == [(7, 0), (0, 0), (0, 8)]
    else:  # a receiver does not look at the ACK slot of others
        assert bit == CRC_DELIMITER + 1


def test_L1_a_flip_that_changes_data_only_is_a_crc_error() -> None:
    queue, wire = network(3)
    sent_through(wire, queue, Flip(60, seen_by="n1"))
    assert wire.errors == {"crc": 1}


def test_L1_passive_receiver_misses_the_frame_and_disturbs_nobody() -> None:
    queue, wire = network(3)
    first, second = listen(wire, 1), listen(wire, 2)
    wire.ports[2].rec = 130
    sent_through(wire, queue, Flip(60, seen_by="n2"))
    assert (len(first), len(second), wire.frames) == (1, 0, 1)
    assert wire.ports[2].rec == 131
    wire.ports[0].send(FRAME, queue.now_ns)
    queue.run_until(queue.now_ns + 1_000_000)
    assert (len(second), wire.ports[2].rec, wire.ports[2].state) == (1, 127, "active")


def test_L1_bus_off_and_recovery_after_128_times_11_recessive_bits() -> None:
    queue, wire = network(2)
    port = wire.ports[0]
    wire.disturb(lambda *_: Flip(50))
    port.send(FRAME, 0)
    while port.state != "bus_off":
        queue.run_until(queue.now_ns + 1000)
    assert (port.tec, wire.errors["bit"], wire.frames) == (256, 32, 0)
    off_ns = queue.now_ns
    wire.disturb(None)
    while port.state == "bus_off":
        queue.run_until(queue.now_ns + 1000)
    # The eight bits of the error delimiter had already begun to count.
    assert 128 * 11 - 8 <= (queue.now_ns - off_ns) // 1000 <= 128 * 11 + 1
    queue.run_until(queue.now_ns + 1_000_000)
    assert (port.tec, wire.frames) == (0, 1)


def test_L1_recovery_counts_one_run_per_frame_on_a_busy_bus() -> None:
    queue, wire = network(3)
    port = wire.ports[0]
    wire.disturb(lambda _t, _f, sender: Flip(50) if sender == "n0" else None)
    port.send(Frame(0x700, bytes(8)), 0)
    while port.state != "bus_off":
        queue.run_until(queue.now_ns + 1000)
    busy = wire.ports[1]

    def refill(t_ns: int, _frame: Frame) -> None:
        busy.send(Frame(1, bytes(8)), t_ns)

    busy.on_sent = refill
    refill(queue.now_ns, FRAME)
    refill(queue.now_ns, FRAME)
    before = wire.frames
    while port.state == "bus_off":
        queue.run_until(queue.now_ns + 1000)
    assert 120 <= wire.frames - before <= 130


def test_L1_two_nodes_with_one_identifier_and_different_data_have_a_bit_error() -> None:
    queue, wire = network(3)
    log = listen(wire, 2)
    wire.ports[0].send(Frame(5, b"\x00"), 0)
    wire.ports[1].send(Frame(5, b"\x01"), 0)
    queue.run_until(10_000_000)
    assert wire.errors["bit"] >= 16
    assert [frame.data for _, frame in log] == [b"\x00", b"\x01"], (
        "the passive one gives way, then has its turn"
    )
    assert all(port.state != "bus_off" for port in wire.ports)


def test_L1_two_nodes_with_the_very_same_frame_both_succeed() -> None:
    queue, wire = network(3)
    log, first = listen(wire, 2), listen(wire, 0)
    done: list[str] = []
    for port in wire.ports[:2]:
        port.on_sent = lambda *_, name=port.name: done.append(name)
        port.send(Frame(5, b"same"), 0)
    queue.run_until(1_000_000)
    assert (len(log), len(first), sorted(done)) == (1, 0, ["n0", "n1"])
    assert not wire.errors


def test_L1_switched_off_in_the_middle_of_its_frame() -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    wire.ports[0].send(FRAME, 0)
    wire.ports[2].send(Frame(0x200, b""), 0)
    queue.run_until(40_000)
    wire.ports[0].online = False
    queue.run_until(1_000_000)
    assert [frame.identifier for _, frame in log] == [0x200]
    assert wire.errors == {"stuff": 1}


def test_L1_a_healthy_wire_after_trouble_is_healthy_again() -> None:
    queue, wire = network(3)
    sent_through(wire, queue, Flip(50))
    wire.disturb(None)
    for _ in range(8):
        wire.ports[0].send(FRAME, queue.now_ns)
        queue.run_until(queue.now_ns + 1_000_000)
    assert all(port.tec == port.rec == 0 for port in wire.ports)
    assert wire.frames == 9


actions = st.lists(
    st.tuples(
        st.integers(0, 300_000),
        st.integers(0, 3),
        st.sampled_from(["send", "send", "send", "off", "on"]),
        st.sampled_from([1, 2, 3, 0x7FF]),
    ),
    max_size=40,
)
flips = st.lists(
    st.one_of(st.none(), st.tuples(st.integers(0, 140), st.sampled_from([None, "n0", "n1", "n3"])))
)


@given(actions, flips)
def test_L1_whatever_happens_time_goes_on_and_frames_that_can_arrive_do(
    batch: list[tuple[int, int, str, int]], disturbances: list[tuple[int, str | None] | None]
) -> None:
    """Four nodes sending the same few identifiers, going off and on, any bits flipped; n4 only listens."""
    queue, wire = network(5)
    left = list(disturbances)

    def disturb(*_: object) -> Flip | None:
        flip = left.pop() if left else None
        return None if flip is None else Flip(*flip)

    wire.disturb(disturb)
    log = listen(wire, 4)
    kept: list[Frame] = []
    switched = {node for _, node, what, _ in batch if what != "send"}
    for number, (t_ns, node, what, identifier) in enumerate(sorted(batch)):
        queue.run_until(t_ns)
        port = wire.ports[node]
        if what == "send":
            frame = Frame(identifier, bytes([number, node]))
            if port.send(frame, t_ns + 5000) and node not in switched:
                kept.append(frame)
        else:
            port.online = what == "on"
    queue.run_until(1_000_000_000)
    heard = [frame for _, frame in log]
    # A frame may come twice (an error in the last bit of EOF), never not at all.
    assert [frame for frame in kept if frame not in heard] == []
    assert all(0 <= port.rec <= 255 and 0 <= port.tec <= 255 for port in wire.ports)
    assert wire.load < 1
    assert all(port.free_buffers == 3 for port in wire.ports if port.online)


def end_after(flip: Flip) -> int:
    """Bit time, from the first start of frame, at which the repeated frame has been delivered."""
    queue, wire = network(3)
    log = listen(wire, 1)
    sent_through(wire, queue, flip)
    return log[-1][0] // 1000


@pytest.mark.parametrize(
    ("flip", "error_bits"),
    [
        # Detected at the bit, then flag 6, delimiter 8, intermission 3.
        (Flip(50), 51 + 6 + 8 + 3),
        # Lost arbitration at bit 3, six recessive bits until it is noticed.
        (Flip(3), 3 + 6 + 1 + 6 + 8 + 3),
        # CRC error of one receiver: flag from the bit after the ACK delimiter on, answered by the others'.
        (Flip(60, seen_by="n2"), CRC_DELIMITER + 3 + 12 + 8 + 3),
    ],
)
def test_L1_an_error_costs_its_error_frame(flip: Flip, error_bits: int) -> None:
    assert end_after(flip) == error_bits + LENGTH


def test_L1_a_passive_sender_waits_eight_bits_more() -> None:
    queue, wire = network(2)
    log = listen(wire, 1)
    port = wire.ports[0]
    port.tec = 140
    wire.disturb(lambda *_: None)  # makes the wire look at the counters
    port.send(FRAME, 0)
    port.send(FRAME, 0)
    queue.run_until(1_000_000)
    assert log[1][0] - log[0][0] == (LENGTH + 3 + 8) * 1000


@given(st.integers(1, LENGTH - 1))
def test_L1_after_a_cut_frame_the_bus_is_busy_until_the_error_frame_is_over(bit: int) -> None:
    queue, wire = network(3)
    log = listen(wire, 1)
    wire.ports[0].send(FRAME, 0)
    wire.ports[2].send(Frame(0x200, b""), 0)
    queue.run_until(bit * 1000 + 1)
    wire.ports[0].online = False
    queue.run_until(1_000_000)
    start = bit * 1000 + 1 + (6 + 6 + 8 + 3) * 1000
    assert [(t_ns, frame.identifier) for t_ns, frame in log] == [
        (start + len(wire_bits(Frame(0x200, b""))) * 1000, 0x200)
    ]


class Told:
    """A watcher that keeps what it is told of failures."""

    def __init__(self) -> None:
        self.failures: list[bool] = []

    def failed(self, _t_ns: int, *, sending: bool) -> None:
        self.failures.append(sending)

    def ignore(self, *_args: object) -> None:
        """Of no interest here."""

    began = lost = counted = activity = ignore


def test_a_missing_acknowledge_is_seen_in_its_slot() -> None:
    """The frame up to the slot (without 1 + 7 + 3 bits behind it), flag 6, delimiter 8, intermission 3."""
    queue, wire = network(1)
    times: list[int] = []
    wire.ports[0].on_error = lambda t_ns, error: times.append(t_ns) if error.kind == "ack" else None
    wire.ports[0].send(FRAME, 0)
    queue.run_until(1_000_000)
    assert {b - a for a, b in itertools.pairwise(times)} == {(frame_bits(FRAME) + 6) * 1000}


def test_both_senders_of_the_very_same_frame_have_sent_it() -> None:
    queue, wire = network(3)
    for port in wire.ports[:2]:
        port.tec = 16
    for port in wire.ports[:2]:
        port.send(FRAME, 0)
    queue.run_until(1_000_000)
    assert [port.tec for port in wire.ports] == [15, 15, 0]


def test_a_passive_sender_that_loses_a_collision_is_told() -> None:
    """Same identifier, other data: its recessive flag ends nothing but its own attempt."""
    queue, wire = network(3)
    told = Told()
    wire.ports[0].watcher = told
    wire.ports[0].tec = 130
    wire.ports[0].send(Frame(0x123, b"\xff" * 8), 0)
    wire.ports[1].send(Frame(0x123, bytes(8)), 0)
    queue.run_until(200_000)
    assert told.failures == [True]
