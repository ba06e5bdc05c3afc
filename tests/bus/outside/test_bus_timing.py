"""How much simulated time a python-can bus lets go by, and how it introduces itself."""

import can
import pytest
from can.typechecking import CanFilter

from bus.can import Frame, Wire
from bus.outside.pythoncan import SchmidtBus
from bus.registry import named, withdraw
from bus.time import EventQueue

MS = 1_000_000


def message(identifier: int = 0x91) -> can.Message:
    return can.Message(arbitration_id=identifier, data=b"x", is_extended_id=False)


@pytest.fixture
def wire() -> Wire:
    return Wire(EventQueue())


def test_a_bus_says_where_it_is(wire: Wire) -> None:
    name = "test-timing"
    with SchmidtBus(wire) as plain, SchmidtBus(name, bitrate=500_000) as by_name:
        assert (plain.channel_info, by_name.channel_info) == ("schmidt wire", f"schmidt {name}")
        assert by_name.wire is named(name) and by_name.wire.bit_ns == 2000
        assert plain.protocol is can.CanProtocol.CAN_20
        first, second = (int(each.port.name.removeprefix("python-can ")) for each in (plain, by_name))
        assert second == first + 1 and first >= 1
    withdraw(name)
    with SchmidtBus(name) as quick:
        assert quick.wire.bit_ns == 1000
    withdraw(name)
    with SchmidtBus() as lab:
        assert lab.wire is named("lab")
    withdraw("lab")


def test_a_message_names_its_channel(wire: Wire) -> None:
    with SchmidtBus(wire, receive_own_messages=True) as one, SchmidtBus(wire) as other:
        one.send(message())
        for bus, is_rx in ((other, True), (one, False)):
            got = bus.recv(1.0)
            assert got is not None and (got.channel, got.is_rx) == ("wire", is_rx)


def test_own_messages_come_back_only_when_asked_for(wire: Wire) -> None:
    with SchmidtBus(wire) as one, SchmidtBus(wire):
        one.send(message())
        assert one.recv(0.01) is None


def test_recv_returns_with_the_frame_and_not_later(wire: Wire) -> None:
    other = wire.attach("other")

    def send(t_ns: int) -> None:
        other.send(Frame(0x91, b""), t_ns)

    wire.queue.at(3 * MS, send)
    wire.queue.at(9 * MS, lambda _: None)
    with SchmidtBus(wire) as bus:
        got = bus.recv(1.0)
        assert got is not None
        assert 3 * MS < wire.queue.now_ns < 4 * MS
        assert bus.recv(0.0) is None and wire.queue.now_ns < 4 * MS
        assert bus.recv(1e-10) is None
        assert wire.queue.next_ns() == 9 * MS


def test_an_event_at_the_very_end_of_a_wait_is_within_it(wire: Wire) -> None:
    seen: list[int] = []
    for t_ns in (5 * MS, 5 * MS + 1):
        wire.queue.at(t_ns, seen.append)
    with SchmidtBus(wire) as bus:
        assert bus.recv(0.005) is None
    assert (seen, wire.queue.now_ns) == ([5 * MS], 5 * MS)


def test_the_one_who_waits_for_a_frame_reads_through_cans_own_door(wire: Wire) -> None:
    with SchmidtBus(wire) as one, SchmidtBus(wire) as other:
        one.send(message())
        got, filtered = other._recv_internal(1.0)
        assert got is not None and filtered is True


@pytest.mark.parametrize(("timeout", "end_ns"), [(None, 1000 * MS), (0.25, 250 * MS), (0.0, 0)])
def test_a_send_waits_for_a_buffer(wire: Wire, timeout: float | None, end_ns: int) -> None:
    """A node alone: its three buffers stay full."""
    with SchmidtBus(wire) as bus:
        for _ in range(3):
            bus.send(message())
        assert wire.queue.now_ns == 0
        with pytest.raises(can.CanTimeoutError, match="no transmit buffer is free"):
            bus.send(message(), timeout)
        assert wire.queue.now_ns == end_ns


def test_a_send_goes_on_as_soon_as_a_buffer_is_free(wire: Wire) -> None:
    wire.attach("other")
    with SchmidtBus(wire) as bus:
        for _ in range(4):
            bus.send(message())
        assert 50_000 < wire.queue.now_ns < 100_000  # one frame of a byte at 1 Mbit/s


def test_who_does_not_drive_is_refused_at_once(wire: Wire) -> None:
    with SchmidtBus(wire, drive=False) as bus:
        for _ in range(3):
            bus.send(message())
        with pytest.raises(can.CanTimeoutError):
            bus.send(message())
        assert wire.queue.now_ns == 0


def test_an_error_state_is_the_ports(wire: Wire) -> None:
    with SchmidtBus(wire) as bus:
        assert bus.state is can.BusState.ACTIVE
        with pytest.raises(NotImplementedError, match="follows from the bus"):
            bus.state = can.BusState.PASSIVE


def test_error_frames_come_unless_they_are_not_wanted(wire: Wire) -> None:
    nothing: list[CanFilter] = [{"can_id": 0x7FF, "can_mask": 0x7FF, "extended": False}]
    with SchmidtBus(wire, can_filters=nothing) as bus:
        bus.send(message())
        got = bus.recv(0.01)
        assert got is not None and got.is_error_frame and got.channel == "wire"
    assert bus.port.on_error is None
    with SchmidtBus(wire, error_frames=False) as bus:
        bus.send(message())
        assert bus.recv(0.01) is None
        assert bus.port.on_error is None


def test_a_bus_that_is_shut_is_off_the_wire(wire: Wire) -> None:
    bus = SchmidtBus(wire)
    assert bus.port in wire.ports
    bus.shutdown()
    assert bus.port not in wire.ports
    assert bus._is_shutdown
