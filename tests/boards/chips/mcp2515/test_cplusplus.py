"""A C++ driver of other people, unmodified, on the chip: ESPHome's, compiled from its wheel on PyPI."""

import ctypes

import pytest

from bus.can import Frame
from tests.boards.chips.mcp2515.cplusplus import (
    ALL_BUSY,
    CLOCKS,
    LISTEN,
    LOOPBACK,
    OK,
    SPEEDS,
    Rig,
    built,
)

pytestmark = [pytest.mark.slow, pytest.mark.timeout(300)]

KINDS = (
    Frame(0x7FF, b""),
    Frame(0x123, bytes(range(8))),
    Frame(0x12345678, b"\xff\x00\x55", True),
    Frame(0x0, b"\x01", True),
    Frame(0x456, bytes(4), False, True),
    Frame(0x1FFFFFFF, bytes(1), True, True),
)


@pytest.fixture(scope="module")
def driver(tmp_path_factory: pytest.TempPathFactory) -> ctypes.CDLL:
    return built(tmp_path_factory.mktemp("driver"))


@pytest.mark.parametrize("fosc_hz", CLOCKS)
@pytest.mark.parametrize("bitrate", SPEEDS)
def test_it_brings_the_chip_up_at_its_rate(driver: ctypes.CDLL, bitrate: int, fosc_hz: int) -> None:
    rig = Rig(driver, bitrate, fosc_hz)
    assert rig.up
    assert rig.chip.times.bitrate == bitrate
    assert rig.send(KINDS[1]) == OK
    rig.run()
    assert rig.partner_heard == [KINDS[1]]


def test_every_kind_of_frame_both_ways(driver: ctypes.CDLL) -> None:
    rig = Rig(driver)
    for frame in KINDS:
        assert rig.send(frame) == OK
        assert rig.partner.send(frame, rig.queue.now_ns)
        rig.run()
        assert rig.loop()[-1] == frame
    assert rig.heard == rig.partner_heard == list(KINDS)


def test_three_frames_fill_its_buffers_and_all_arrive(driver: ctypes.CDLL) -> None:
    rig = Rig(driver, bitrate=50_000)
    frames = [Frame(0x100 + number, bytes(8)) for number in range(3)]
    assert [rig.send(frame) for frame in (*frames, Frame(0x103, b""))] == [OK, OK, OK, ALL_BUSY]
    rig.run(20)
    assert sorted(rig.partner_heard, key=str) == frames
    assert rig.send(Frame(0x103, b"")) == OK


def test_two_frames_wait_for_it_and_a_third_overruns(driver: ctypes.CDLL) -> None:
    rig = Rig(driver)
    frames = [Frame(0x200 + number, bytes([number])) for number in range(3)]
    for frame in frames:
        rig.partner.send(frame, rig.queue.now_ns)
        rig.run()
    assert rig.chip.transfer(bytes((0x03, 0x2D, 0)))[2] & 0xC0  # EFLG: RX0OVR or RX1OVR
    assert rig.loop() == frames[:2]


def test_loop_back_and_listen_only_leave_the_wire_alone(driver: ctypes.CDLL) -> None:
    rig = Rig(driver, mode=LOOPBACK)
    assert rig.send(KINDS[2]) == OK
    rig.run()
    assert rig.loop() == [KINDS[2]]
    assert rig.wire.frames == 0
    deaf = Rig(driver, mode=LISTEN)
    deaf.send(KINDS[1])
    deaf.partner.send(KINDS[1], deaf.queue.now_ns)
    deaf.run()
    assert (deaf.wire.frames, deaf.partner_heard) == (0, [])  # nobody acknowledges
