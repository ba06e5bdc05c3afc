import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.silicon.endat import EndatEncoder, EndatMaster, check, crc5

positions = st.integers(0, (1 << 29) - 1)


@pytest.mark.parametrize(
    ("position", "healthy", "alarm"),
    [  # derived vectors of hardware.md 3.1
        (0, 26, 1),
        (1, 18, 9),
        (1 << 28, 17, 10),
        ((1 << 29) - 1, 10, 17),
        (0x12345678, 30, 5),
        (123456789, 19, 8),
    ],
)
def test_P8_crc_of_position_frames(position: int, healthy: int, alarm: int) -> None:
    encoder = EndatEncoder(lambda _t: position)
    assert encoder.transfer(0) >> 31 == healthy
    encoder.alarm = True
    assert encoder.transfer(0) >> 31 == alarm


def test_crc_of_the_published_endat_2_1_vector() -> None:
    # makeCrcPos(25 clocks, F1 = 0, 1234324343) = 29 and makeCrcNorm(100, 10000) = 30 (hardware.md 3.1)
    assert crc5((1234324343 & (1 << 25) - 1) << 1, 26) == 29
    word = f"{100:08b}{10000:016b}"
    assert crc5(int(word[::-1], 2), 24) == 30


@given(positions)
def test_B3_a_frame_arrives_as_it_was_sent(position: int) -> None:
    encoder = EndatEncoder(lambda _t: position)
    master = EndatMaster(encoder)
    assert master.poll(0) == (position, False, True)
    encoder.alarm = True
    assert master.poll(0) == (position, True, True)
    master.line = lambda frame: frame  # a cable that is there and disturbs nothing
    assert master.poll(0) == (position, True, True)
    encoder.alarm = False
    assert master.poll(0) == (position, False, True)


@pytest.mark.parametrize(("flags", "alarm"), [(0b10, False), (0b01, True), (0b00, True), (0b11, True)])
def test_B3_error_bits_that_agree_are_an_alarm_too(flags: int, alarm: bool) -> None:
    """F1 is active high, F2 active low (hardware.md 3.1); the CRC is right."""
    data = 12345 << 2 | flags
    assert check(data | crc5(data, 31) << 31) == (12345, alarm, True)


@given(positions, st.integers(0, 35))
def test_B3_every_single_bit_error_is_seen(position: int, bit: int) -> None:
    master = EndatMaster(EndatEncoder(lambda _t: position))
    master.line = lambda frame: frame ^ 1 << bit
    assert not master.poll(0)[2]


def test_errors_fifteen_bits_apart_pass_as_the_polynomial_has_it() -> None:
    # order 15: 27 of the 630 two-bit errors in 36 bits cannot be seen (hardware.md 3.1, trap ii)
    sent = EndatEncoder(lambda _t: 0x0ABCDEF).transfer(0)
    order = [*range(31), 35, 34, 33, 32, 31]  # the CRC goes out highest bit first
    missed = [(a, b) for b in range(36) for a in range(b) if check(sent ^ 1 << order[a] ^ 1 << order[b])[2]]
    assert len(missed) == 27
    assert {b - a for a, b in missed} == {15, 30}


def test_negative_positions_wrap_to_29_bits() -> None:
    assert EndatMaster(EndatEncoder(lambda _t: -1)).poll(0)[0] == (1 << 29) - 1


def test_the_transfer_takes_less_than_the_poll() -> None:
    # 47 clocks (2 + 6 + 2, a start bit, 31 and 5 bits) and t_cal of 5 us (hardware.md 3.1)
    encoder = EndatEncoder(lambda _t: 0)
    assert EndatMaster(encoder).latch_to_data_ns == 52_000
    assert EndatMaster(encoder, 2_000_000).latch_to_data_ns == 28_500
