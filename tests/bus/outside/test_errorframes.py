"""Error frames of `linux/can/error.h` at whoever listens: on the wire's own interface, and behind a door."""

from collections.abc import Iterator

import can
import pytest

from bus.can import Flip, Frame, Wire
from bus.can.disturbance import seen_by_receiver
from bus.can.stuck import StuckDominant
from bus.outside.door import Door
from bus.outside.pythoncan import SchmidtBus
from bus.time import EventQueue

# Values of include/uapi/linux/can/error.h, written out: the header is the reference, not the code.
CRTL, PROT, ACK, BUSOFF, BUSERROR, RESTARTED = 0x04, 0x08, 0x20, 0x40, 0x80, 0x100
RX_PASSIVE, TX_PASSIVE, ACTIVE, TX_WARNING = 0x10, 0x20, 0x40, 0x08
PROT_BIT, PROT_FORM, PROT_STUFF, PROT_TX = 0x01, 0x02, 0x04, 0x80
FRAME = Frame(0x123, b"\x00" * 8)


@pytest.fixture
def wire() -> Wire:
    return Wire(EventQueue())


@pytest.fixture
def bus(wire: Wire) -> Iterator[SchmidtBus]:
    with SchmidtBus(wire, drive=False) as bus:
        yield bus


def errors(bus: can.BusABC) -> list[can.Message]:
    found = []
    while (message := bus.recv(0)) is not None:
        if message.is_error_frame:
            found.append(message)
    return found


def classes(messages: list[can.Message]) -> list[int]:
    return [message.arbitration_id & ~0x200 for message in messages]


def test_a_healthy_bus_has_none(wire: Wire, bus: SchmidtBus) -> None:
    other = wire.attach("other")
    for k in range(50):
        other.send(FRAME, k * 1_000_000)
        wire.queue.run_until((k + 1) * 1_000_000)
    assert errors(bus) == []
    assert not wire._near


def test_a_missing_acknowledge_and_the_passive_state_it_ends_in(wire: Wire, bus: SchmidtBus) -> None:
    bus.send(can.Message(arbitration_id=0x10, is_extended_id=False, data=b"x"))
    wire.queue.run_until(20_000_000)
    found = errors(bus)
    assert classes(found)[0] == ACK
    changes = [message for message in found if message.arbitration_id & CRTL]
    assert [message.data[1] for message in changes] == [TX_WARNING, TX_PASSIVE]
    assert [message.data[6] for message in changes] == [96, 128]  # TEC, by eights
    assert len(found) < 6  # once in 10 ms, though the frame is repeated all the time


def test_an_error_of_somebody_else_is_a_protocol_violation(wire: Wire, bus: SchmidtBus) -> None:
    other = wire.attach("other")
    wire.disturb(lambda _t, _frame, _sender: Flip(20))
    other.send(FRAME, 0)
    wire.queue.run_until(45_000)  # one error frame, and the repetition has begun
    wire.disturb(None)
    (message,) = errors(bus)
    assert classes([message]) == [PROT | BUSERROR]
    assert message.data[2] == PROT_STUFF  # six dominant bits of the sender, who saw its bit inverted
    assert message.data[7] == 1  # REC
    assert message.timestamp == pytest.approx(30e-6, abs=30e-6)


@pytest.mark.parametrize(("receivers", "senders"), [("stuff", PROT_BIT), ("crc", PROT_FORM)])
def test_a_sender_calls_a_receivers_flag_what_it_is_to_a_sender(
    wire: Wire, bus: SchmidtBus, receivers: str, senders: int
) -> None:
    """One receiver sees a bit inverted. Its flag meets recessive bits at once, or, behind a wrong CRC, in the
    end of frame."""
    wire.attach("other")
    frame = Frame(0x123, b"\x1f" * 8)
    seen = {bit: seen_by_receiver(frame, bit) for bit in range(19, 90)}
    bit = next(bit for bit, verdict in seen.items() if verdict is not None and verdict.kind == receivers)
    wire.disturb(lambda _t, _frame, _sender: Flip(bit, "other"))
    bus.send(can.Message(arbitration_id=0x123, is_extended_id=False, data=frame.data))
    wire.queue.run_until(200_000)
    wire.disturb(None)
    assert errors(bus)[0].data[2] == PROT_TX | senders


def test_bus_off_and_the_way_back(wire: Wire, bus: SchmidtBus) -> None:
    wire.attach("other")
    wire.disturb(lambda _t, _frame, sender: Flip(20) if sender != "other" else None)
    bus.send(can.Message(arbitration_id=0x10, is_extended_id=False, data=b"\x00" * 8))
    wire.queue.run_until(10_000_000)
    wire.disturb(None)
    wire.queue.run_until(20_000_000)
    found = classes(errors(bus))
    assert BUSOFF in found
    assert found.index(BUSOFF) < found.index(RESTARTED | CRTL)
    assert bus.state is can.BusState.ACTIVE


def test_a_bus_held_dominant_makes_a_receiver_passive(wire: Wire, bus: SchmidtBus) -> None:
    wire.attach("other")
    wire.queue.run_until(1_000_000)
    stuck = StuckDominant(wire, wire.queue.now_ns)
    wire.queue.run_until(2_000_000)
    found = errors(bus)
    assert classes(found)[0] == PROT | BUSERROR
    assert found[0].data[2] == PROT_STUFF
    assert RX_PASSIVE in [message.data[1] for message in found]
    stuck.release(wire.queue.now_ns)


def test_who_does_not_want_them_gets_none(wire: Wire) -> None:
    with SchmidtBus(wire, drive=False, error_frames=False) as bus:
        bus.send(can.Message(arbitration_id=0x10, is_extended_id=False, data=b"x"))
        wire.queue.run_until(20_000_000)
        assert errors(bus) == []


def test_they_reach_a_program_behind_a_door(wire: Wire) -> None:
    with (
        can.Bus(interface="virtual", channel="errors") as inner,
        can.Bus(interface="virtual", channel="errors") as outer,
    ):
        door = Door(wire.queue, wire, inner)
        other = wire.attach("other")
        wire.disturb(lambda _t, _frame, _sender: Flip(20))
        other.send(FRAME, 0)
        wire.queue.run_until(10_000_000)
        found = errors(outer)
        assert PROT | BUSERROR in classes(found)
        assert any(message.data[1] & RX_PASSIVE for message in found)
        door.close()
        wire.queue.run_until(20_000_000)
        assert errors(outer) == []
