from bus.can import Frame
from bus.protocol import (
    AGE_UNIT_NS,
    Device,
    Health,
    Opcode,
    PositionFlag,
    Result,
    unpack_position,
    unpack_summary,
)
from bus.protocol.serial import PacketDecoder
from tests.boards.lab import CENTRE, Lab

BOARD = Device.POSITION_RA


def frames(lab: Lab, identifier: int) -> list[tuple[int, Frame]]:
    return [(t, frame) for t, frame in lab.frames if frame.identifier == identifier]


def test_B3_position_every_5_ms_with_its_age() -> None:
    lab = Lab()
    latched: list[int] = []
    lab.position.endat.encoder.pin = lambda t_ns: latched.append(t_ns) or CENTRE + len(latched)
    lab.run(1.0)
    got = frames(lab, 0x221)
    assert len(got) in (199, 200, 201)
    readings = [unpack_position(frame.data) for _, frame in got]
    assert [r.position for r in readings] == [CENTRE + k + 1 for k in range(len(got))]
    assert [r.sequence for r in readings] == [(k + 1) % 256 for k in range(len(got))]
    for (t_ns, _), reading, latch_ns in zip(got, readings, latched, strict=False):
        loaded_ns = latch_ns + reading.age * AGE_UNIT_NS
        # from the buffer over an almost idle wire: one frame of 111 to 135 bits, one more when it is taken
        assert 100_000 < t_ns - loaded_ns < 300_000


def test_B3_a_bad_crc_is_flagged_and_not_used() -> None:
    lab = Lab()
    lab.run(0.1)
    lab.position.endat.line = lambda frame: frame ^ 1 << 12
    lab.run(0.1)
    reading = unpack_position(frames(lab, 0x221)[-1][1].data)
    assert reading.flags & PositionFlag.CRC_ERROR
    assert reading.position == CENTRE
    assert lab.command(Opcode.PING, device=BOARD).value & Health.SENSOR


def test_B3_alarm_and_soft_limits_are_flags() -> None:
    lab = Lab()
    lab.run(0.1)
    lab.position.endat.encoder.alarm = True
    assert lab.command(Opcode.SET_PARAMETER, 4, CENTRE + 10, device=BOARD).result == Result.OK
    lab.run(0.3)
    flags = unpack_position(frames(lab, 0x221)[-1][1].data).flags
    assert flags == PositionFlag.ALARM | PositionFlag.LIMIT_LOW
    assert unpack_summary(frames(lab, 0x321)[-1][1].data).flags == flags
    assert lab.command(Opcode.SET_PARAMETER, 5, 1 << 29, device=BOARD).result == Result.OUT_OF_RANGE
    assert lab.command(Opcode.POWER, 1, device=BOARD).result == Result.UNKNOWN_OPCODE


def test_L3_packets() -> None:
    lab = Lab()
    packets: list[bytes] = []
    lab.position.uart.sink = lambda _t, packet: packets.append(packet)
    lab.run(1.2)
    decoded = PacketDecoder().feed(b"".join(packets))
    assert len(decoded) == 4
    assert all(row == (CENTRE,) for packet in decoded for row in packet.rows)
