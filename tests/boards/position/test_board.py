from itertools import pairwise

import pytest

from boards.position.firmware import FCY_HZ, TABLE, PositionBoard
from bus.can import Frame, Wire
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
from bus.time import Oscillator
from tests.boards.lab import CENTRE, Lab
from tests.boards.places import place
from tests.boards.tables import times_ns

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


@pytest.mark.parametrize(("low", "high", "flags"), [
    (CENTRE, CENTRE, 0), (CENTRE + 1, CENTRE + 2, PositionFlag.LIMIT_LOW),
    (CENTRE - 2, CENTRE - 1, PositionFlag.LIMIT_HIGH),
])  # fmt: skip
def test_B3_a_limit_itself_is_within(low: int, high: int, flags: int) -> None:
    """The age, too: 1200 cycles at 10 MHz until the frame is loaded, in units of 4 us."""
    lab = Lab()
    assert (lab.position.low, lab.position.high) == (0, (1 << 29) - 1)
    lab.position.low, lab.position.high = low, high
    lab.run(0.1)
    reading = unpack_position(frames(lab, 0x221)[-1][1].data)
    assert (reading.flags, reading.age) == (flags, 30)


def test_B3_its_limits_are_parameters_of_29_bits() -> None:
    table = Lab().position.parameters
    for number in (4, 5):
        for value, beyond in ((0, -1), ((1 << 29) - 1, 1)):
            assert table.set(number, value) == (Result.OK, number, value)
            assert table.set(number, value + beyond) == (Result.OUT_OF_RANGE, number, value)
    assert [row.number for row in table.rows()] == [4, 5]


def test_B3_a_first_reading_that_is_bad_is_no_position_and_power_up_forgets_it() -> None:
    lab = Lab()
    lab.position.endat.line = lambda frame: frame ^ 1 << 12
    lab.run(0.1)
    reading = unpack_position(frames(lab, 0x221)[-1][1].data)
    assert (reading.position, reading.flags) == (0, PositionFlag.CRC_ERROR)
    lab.position.power_off(lab.queue.now_ns)
    lab.run(0.1)
    lab.frames.clear()
    lab.position.endat.line = None
    packets: list[int] = []
    lab.position.uart.sink = lambda t_ns, _data: packets.append(t_ns)
    lab.position.power_on(lab.queue.now_ns)
    while not lab.position.on:
        lab.run(0.001)
    assert not lab.position.health() & Health.SENSOR  # before it has read anything
    on_ns = lab.queue.now_ns
    lab.run(0.3)
    assert unpack_position(frames(lab, 0x221)[0][1].data).position == CENTRE
    assert packets and packets[0] > on_ns + 240_000_000  # 25 samples of now
    never = PositionBoard(place(BOARD, Wire(lab.queue), Oscillator(0.0, 0)), lambda _t: 0)
    assert not never.health() & Health.SENSOR


def test_B3_periods_of_its_frames_and_a_sequence_of_eight_bits() -> None:
    """POSITION every 5 ms, SUMMARY every 250 ms, HEARTBEAT every second, never two of them at once."""
    lab = Lab()
    lab.run(4.0)
    for identifier, period_ns in ((0x221, 5_000_000), (0x321, 250_000_000), (0x721, 1_000_000_000)):
        times = [t_ns for t_ns, _ in frames(lab, identifier)]
        assert abs(len(times) - 4_000_000_000 // period_ns) <= 1
        assert all(abs(after - before - period_ns) < 400_000 for before, after in pairwise(times))
    sequence = [unpack_position(frame.data).sequence for _, frame in frames(lab, 0x221)]
    assert sequence == [(k + 1) % 256 for k in range(len(sequence))]
    slow = [t_ns for identifier in (0x321, 0x721) for t_ns, _ in frames(lab, identifier)]
    assert all(after - before > 4_000_000 for before, after in pairwise(sorted(slow)))
    summary = unpack_summary(frames(lab, 0x321)[-1][1].data)
    assert (summary.flags, summary.position) == (0, CENTRE)


def test_L3_packets() -> None:
    lab = Lab()
    packets: list[bytes] = []
    lab.position.uart.sink = lambda _t, packet: packets.append(packet)
    lab.run(1.2)
    decoded = PacketDecoder().feed(b"".join(packets))
    assert len(decoded) == 4
    assert all(row == (CENTRE,) for packet in decoded for row in packet.rows)


def test_B3_routines_take_the_times_that_are_published() -> None:
    assert times_ns(TABLE, FCY_HZ) == {"sample": (1200, 120_000), "can": (1200, 40_000)}
    assert [line.level for line in TABLE] == [line.name == "can" for line in TABLE]
