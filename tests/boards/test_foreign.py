"""Frames with a peer's identifier that are no frames of it, and values that do not fit."""

import pytest

from bus.can import Frame, Port
from bus.protocol import (
    COMMAND_BASE,
    HEARTBEAT_BASE,
    MEASUREMENT_BASE,
    REPLY_BASE,
    SUMMARY_BASE,
    Device,
    Health,
    Opcode,
    Result,
    pack_command,
    pack_tach,
    unpack_motion,
    unpack_target,
)
from bus.protocol.motion import pack_motion
from bus.protocol.position import pack_target
from bus.protocol.serial import SAMPLES, AxisSample, PacketDecoder, pack_packet
from tests.boards.lab import Lab

PEERS = (0x221, 0x231, 0x232)


def ill(lab: Lab) -> Health:
    return Health(lab.command(Opcode.PING).value)


@pytest.mark.parametrize("identifier", PEERS)
@pytest.mark.parametrize("length", range(8))
def test_a_short_frame_of_a_peer_is_dropped_counted_and_said(identifier: int, length: int) -> None:
    lab = Lab()
    lab.run(0.1)
    lab.pc.send(Frame(identifier, bytes([identifier & 0x7F, *range(7)])[:length]), lab.queue.now_ns)
    lab.run(0.1)
    assert lab.axis.foreign == 1
    assert Health.FOREIGN in ill(lab)
    lab.run(11.0)
    assert lab.axis.foreign == 1
    assert Health.FOREIGN not in ill(lab), "ten seconds later the board is well again"


@pytest.mark.parametrize(
    "frame",
    [
        Frame(0x221, bytes([0x22, *range(7)])),  # another board's bytes
        Frame(0x231, bytes(8)),
        Frame(0x221, bytes(8), remote=True),
    ],
)
def test_a_frame_that_names_another_board_or_none_is_dropped(frame: Frame) -> None:
    lab = Lab()
    lab.run(0.1)
    position = lab.axis.motion.position
    lab.pc.send(frame, lab.queue.now_ns)
    lab.run(0.004)
    assert (lab.axis.foreign, lab.axis.motion.position) == (1, position)


def test_an_extended_frame_with_a_peers_number_is_nobodys() -> None:
    lab = Lab()
    lab.run(0.1)
    lab.pc.send(Frame(0x221, bytes(8), extended=True), lab.queue.now_ns)
    lab.run(0.1)
    assert lab.axis.foreign == 0


@pytest.mark.parametrize("phase_ms", range(20))
def test_a_forged_tach_whose_count_jumps_costs_no_packet(phase_ms: int) -> None:
    lab = Lab()
    lab.run(1.0 + phase_ms * 1e-3)
    tach = pack_tach(Device.MOTOR_RA_A, 0, lab.boards[2].count + 40_000, 0)  # type: ignore[attr-defined]
    before = len(lab.packets)
    lab.pc.send(Frame(0x231, tach), lab.queue.now_ns)
    lab.run(1.0)
    assert len(lab.packets) >= before + 3
    decoder = PacketDecoder()
    rows = [row for _, data in lab.packets for packet in decoder.feed(data) for row in packet.rows]
    assert decoder.crc_errors == 0
    seen = {AxisSample(*row).tach_a for row in rows}
    assert seen <= set(range(-32768, 32768))
    if lab.axis.clipped:
        assert 32767 in seen or -32768 in seen
        assert Health.RANGE in ill(lab)


def test_a_packet_takes_samples_beyond_its_fields() -> None:
    lab = Lab()
    lab.run(1.0)
    sample = (0, 0, 0, 0, 0, 40_000, -40_000, 0, 0)
    told: list[int] = []
    data = pack_packet(Device.AXIS_RA, 0, 0, [sample] * SAMPLES, lambda: told.append(1))
    (packet,) = PacketDecoder().feed(data)
    assert {row[5:7] for row in packet.rows} == {(32767, -32768)}
    assert told == [1]


def test_packers_saturate_instead_of_wrapping() -> None:
    told: list[int] = []

    def clip() -> None:
        told.append(1)

    motion = unpack_motion(pack_motion(0x11, 1, 20_000, -5000, (1, 2), clip))
    assert (motion.velocity, motion.effort) == (16383, -4096)
    assert unpack_target(pack_target(0x11, 1, 0, 1 << 40, clip)).distance == (1 << 31) - 1
    assert told == [1, 1]


def test_what_the_gateway_cannot_name_never_reaches_the_pc() -> None:
    from tests.boards.gateway.test_board import Bench

    bench = Bench()
    for identifier, data in ((0x291, b"\x91" + bytes(7)), (0x311, b"\x11\x05" + bytes(6))):
        bench.node.send(Frame(identifier, data), bench.queue.now_ns)
    bench.queue.run_until(20_000_000)
    assert bench.frames == []
    assert bench.board.foreign == 2


def flooded(identifier: int) -> Lab:
    """A lab after 0.1 s whose PC sends this identifier without a pause, from three buffers."""
    lab = Lab()
    lab.run(0.1)
    lab.pc.on_sent = lambda t_ns, frame: lab.pc.send(frame, t_ns) and None
    for _ in range(3):
        lab.pc.send(Frame(identifier, bytes(8)), lab.queue.now_ns)
    return lab


def test_what_found_no_room_is_said_for_ten_seconds_and_counted_for_good() -> None:
    """A flood of the highest priority keeps the axis board's frames in its three buffers."""
    lab = flooded(0)
    lab.run(0.1)
    lab.pc.on_sent = None
    lab.run(0.01)
    lost = lab.axis.dropped
    assert lost > 0
    assert Health.DROPPED in ill(lab)
    lab.run(11.0)
    assert Health.DROPPED not in ill(lab), "ten seconds later the board is well again"
    assert lab.axis.dropped == lost


def test_a_bus_full_of_less_important_frames_costs_no_measurement() -> None:
    """Heartbeats lose against 0x6F0 for ever; the old ones must not fill the three transmit buffers."""
    lab = flooded(0x6F0)
    seen: dict[int, list[int]] = {}
    lab.wire.tap(lambda t_ns, frame, _sender: seen.setdefault(frame.identifier, []).append(t_ns))
    lab.run(5.0)
    lab.pc.on_sent = None
    assert len(seen[MEASUREMENT_BASE + Device.AXIS_RA]) >= 499
    assert len(seen[SUMMARY_BASE + Device.AXIS_RA]) == 20
    assert HEARTBEAT_BASE + Device.AXIS_RA not in seen, "it waits, as the least important"
    assert lab.axis.dropped == 0
    lab.run(0.01)
    assert len(seen[HEARTBEAT_BASE + Device.AXIS_RA]) == 1, "the newest, not all that were due"


def pestered() -> tuple[Lab, Port, list[int]]:
    """Eight commands in a row for the axis board, on a bus where frames before its replies come without end;
    the parameters that are answered."""
    lab = Lab()
    lab.run(0.1)
    answered: list[int] = []
    commands = [
        Frame(COMMAND_BASE + Device.AXIS_RA, pack_command(Device.AXIS_RA, Opcode.GET_PARAMETER, number))
        for number in range(1, 9)
    ]
    busy = lab.wire.attach("busy")
    busy.on_sent = lambda t_ns, frame: busy.send(frame, t_ns) and None
    busy.send(Frame(0x0FF, bytes(8)), lab.queue.now_ns)
    lab.wire.tap(
        lambda _t, frame, _s: (
            answered.append(frame.data[3]) if frame.identifier == REPLY_BASE + Device.AXIS_RA else None
        )
    )
    lab.pc.on_sent = lambda t_ns, _frame: commands and lab.pc.send(commands.pop(0), t_ns) and None
    lab.pc.send(commands.pop(0), lab.queue.now_ns)
    lab.run(0.01)
    return lab, busy, answered


def test_every_command_is_answered_once_when_the_replies_find_no_buffer() -> None:
    lab, busy, answered = pestered()
    assert answered == [] and lab.axis.port.free_buffers == 0
    busy.on_sent = None
    lab.run(0.01)
    assert answered == list(range(1, 9))
    assert lab.axis.port.on_sent is None
    assert Result(lab.command(Opcode.PING).result) is Result.OK


def test_a_board_that_loses_its_supply_with_a_reply_in_hand_begins_anew() -> None:
    lab, busy, answered = pestered()
    lab.axis.power_off(lab.queue.now_ns)
    busy.on_sent = None
    lab.run(0.01)
    lab.axis.power_on(lab.queue.now_ns)
    lab.run(1.0)
    assert answered == []
    assert Result(lab.command(Opcode.PING).result) is Result.OK
