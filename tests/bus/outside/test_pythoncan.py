"""The wire through python-can's own front door."""

from collections.abc import Iterator
from pathlib import Path

import can
import pytest

from bus import protocol as p
from bus.can import Frame, Wire
from bus.outside.pythoncan import SchmidtBus
from bus.protocol.database import database
from bus.registry import NameTakenError, named, publish, withdraw
from bus.time import EventQueue

PING = can.Message(arbitration_id=0x091, data=p.pack_command(0x11, p.Opcode.PING), is_extended_id=False)


@pytest.fixture
def lab() -> Iterator[Wire]:
    yield named("test-lab")
    withdraw("test-lab")


def test_L1_the_entry_point_opens_the_named_wire(lab: Wire) -> None:
    with can.Bus(interface="schmidt", channel="test-lab") as one, SchmidtBus(lab) as other:
        assert isinstance(one, SchmidtBus)
        assert one.wire is lab
        one.send(PING)
        got = other.recv(1.0)
        assert got is not None
        assert (got.arbitration_id, bytes(got.data), got.is_rx) == (0x091, bytes(PING.data), True)
        assert got.timestamp == lab.queue.now_ns * 1e-9 < 150e-6
        assert one.recv(0.0) is None


def test_recv_lets_simulated_time_go_by_and_no_more(lab: Wire) -> None:
    with SchmidtBus(lab) as bus:
        assert bus.recv(1.5) is None
        assert lab.queue.now_ns == 1_500_000_000
        lab.queue.at(2_000_000_000, lambda _: None)
        assert bus.recv(None) is None, "nothing is left that could happen"
        assert lab.queue.now_ns == 2_000_000_000


def test_drive_false_leaves_time_alone(lab: Wire) -> None:
    with SchmidtBus(lab, drive=False) as bus:
        assert bus.recv(1.0) is None
        assert lab.queue.now_ns == 0


def test_filters_and_own_messages(lab: Wire) -> None:
    wanted = [{"can_id": 0x211, "can_mask": 0x7FF, "extended": False}]
    with (
        SchmidtBus(lab, receive_own_messages=True) as sender,
        SchmidtBus(lab, can_filters=wanted) as receiver,
    ):
        for identifier in (0x091, 0x211):
            sender.send(can.Message(arbitration_id=identifier, is_extended_id=False))
        got = receiver.recv(1.0)
        assert got is not None
        assert got.arbitration_id == 0x211
        own = [sender.recv(0.1), sender.recv(0.1)]
        assert [(m.arbitration_id, m.is_rx) for m in own if m] == [(0x091, False), (0x211, False)]


def test_more_frames_than_buffers_wait_for_the_bus(lab: Wire) -> None:
    with SchmidtBus(lab) as sender, SchmidtBus(lab) as receiver:
        for number in range(10):
            sender.send(can.Message(arbitration_id=number, is_extended_id=True, is_remote_frame=number == 3))
        got = [receiver.recv(1.0) for _ in range(10)]
        assert [m.arbitration_id for m in got if m] == list(range(10))
        assert got[3] is not None
        assert got[3].is_remote_frame


def test_a_node_alone_is_never_acknowledged(lab: Wire) -> None:
    with SchmidtBus(lab) as bus:
        for _ in range(3):
            bus.send(PING)
        with pytest.raises(can.CanTimeoutError, match="acknowledge"):
            bus.send(PING, timeout=0.1)
        assert bus.state is can.BusState.PASSIVE


def test_what_can_2_does_not_carry_is_refused(lab: Wire) -> None:
    with SchmidtBus(lab) as bus:
        with pytest.raises(can.CanOperationError, match="CAN FD"):
            bus.send(can.Message(arbitration_id=1, is_fd=True, data=bytes(12)))
        with pytest.raises(NotImplementedError, match=r"EventQueue\.at"):
            bus.send_periodic(PING, 0.1)


def test_loggers_and_cantools_work_on_it(lab: Wire, tmp_path: Path) -> None:
    path = tmp_path / "can.log"
    with SchmidtBus(lab) as sender, SchmidtBus(lab) as receiver, can.Logger(path) as logger:
        data = p.pack_position(0x21, p.PositionFlag.WARNING, 123_456, 7, 8)
        sender.send(can.Message(arbitration_id=0x221, data=data, is_extended_id=False))
        got = receiver.recv(1.0)
        assert got is not None
        logger(got)
    (back,) = can.LogReader(path)
    decoded = database().decode_message(back.arbitration_id, back.data)
    assert (decoded["Position"], decoded["Warning"], decoded["Age"]) == (123_456, 1, 7)


def test_leaving_the_wire(lab: Wire) -> None:
    bus = SchmidtBus(lab)
    bus.shutdown()
    bus.shutdown()
    assert not lab.ports


def test_a_name_belongs_to_one_wire(lab: Wire) -> None:
    publish("test-lab", lab)
    with pytest.raises(NameTakenError, match="test-lab"):
        publish("test-lab", Wire(EventQueue()))


def test_remote_and_plain_frames_survive_the_way_there_and_back() -> None:
    from bus.outside.messages import to_frame, to_message

    for frame in (Frame(5, b"ab"), Frame(5, bytes(3), remote=True), Frame(0x1234567, b"", extended=True)):
        assert to_frame(to_message(frame, 0)) == frame
