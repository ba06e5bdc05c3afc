import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from bus.can import Frame, FrameError
from bus.can.bits import crc15, header_bits, number_bits, stuff, stuffed_field, wire_bits
from bus.can.frame import arbitration_key
from bus.can.length import frame_bits, plain_bits

# Identifier, data, CRC-15, stuff bits, bits with intermission; found apart from this code (hardware.md 3.3).
VECTORS = [
    (0x000, "", 0x0000, 6, 53),
    (0x7FF, "", 0x272F, 3, 50),
    (0x123, "0102030405060708", 0x64EF, 8, 119),
    (0x555, "AAAAAAAAAAAAAAAA", 0x7DCE, 1, 112),
    (0x100, "00CA22FF5566AADF", 0x4BAB, 6, 117),
]
frames = st.one_of(
    st.builds(Frame, st.integers(0, 0x7FF), st.binary(max_size=8), st.just(False), st.booleans()),
    st.builds(Frame, st.integers(0, 0x1FFF_FFFF), st.binary(max_size=8), st.just(True), st.booleans()),
    # Long runs, where the stuffing is.
    st.builds(
        Frame,
        st.sampled_from([0, 0x7FF, 0x7E0, 0x01F]),
        st.lists(st.sampled_from([0x00, 0xFF, 0x0F, 0xF0, 0x07, 0xF8, 0x83]), min_size=8, max_size=8).map(
            bytes
        ),
    ),
)


@pytest.mark.parametrize(("identifier", "data", "crc", "stuffed", "total"), VECTORS)
def test_L1_published_vectors(identifier: int, data: str, crc: int, stuffed: int, total: int) -> None:
    frame = Frame(identifier, bytes.fromhex(data))
    plain = stuffed_field(frame)
    assert crc15(plain[:-15]) == crc
    assert len(stuff(plain)) - len(plain) == stuffed
    assert frame_bits(frame) == total


def test_L1_crc_check_value() -> None:
    assert crc15([bit for byte in b"123456789" for bit in number_bits(byte, 8)]) == 0x059E


@given(frames)
def test_L1_tables_agree_with_the_bits(frame: Frame) -> None:
    assert frame_bits(frame) == len(wire_bits(frame)) + 3


@given(frames)
def test_L1_stuffing_leaves_no_run_of_six_and_can_be_undone(frame: Frame) -> None:
    plain = stuffed_field(frame)
    wire = stuff(plain)
    assert all(len(set(wire[i : i + 6])) == 2 for i in range(len(wire) - 5))
    back, run, last = [], 0, -1
    for bit in wire:
        if run == 5:
            run, last = 1, bit
            continue
        back.append(bit)
        run = run + 1 if bit == last else 1
        last = bit
    assert back == plain


@given(frames)
def test_L1_length_stays_within_the_published_worst_case(frame: Frame) -> None:
    payload = 0 if frame.remote else 8 * len(frame.data)
    fixed, stuffable = (67, 54) if frame.extended else (47, 34)
    assert fixed + payload <= frame_bits(frame) <= fixed + payload + (stuffable + payload - 1) // 4


@given(frames, frames)
def test_L1_the_key_orders_as_the_bits_do(one: Frame, other: Frame) -> None:
    def field(frame: Frame) -> list[int]:
        return header_bits(frame)[1 : 33 if frame.extended else 14]

    if arbitration_key(one) < arbitration_key(other):
        assert field(one) < field(other)


@pytest.mark.parametrize(
    "frame", [Frame(0x800, b""), Frame(-1, b""), Frame(1 << 29, b"", True), Frame(1, bytes(9))]
)
def test_L1_what_can_cannot_carry_is_refused(frame: Frame) -> None:
    for count in (frame_bits, stuffed_field):
        with pytest.raises(FrameError):
            count(frame)


@pytest.mark.parametrize(
    ("frame", "bits"),
    [  # SOF, 11 bits, SRR, IDE, 18 bits, RTR, r1, r0, DLC, written out by hand (ISO 11898-1)
        (Frame(0x12345678, bytes(3), True), "0 10010001101 1 1 000101011001111000 0 0 0 0011"),
        (Frame(0x1FFFFFFF, b"", True, True), "0 11111111111 1 1 111111111111111111 1 0 0 0000"),
        (Frame(0x00020001, b"", True), "0 00000000000 1 1 100000000000000001 0 0 0 0000"),
        (Frame(0x123, bytes(8)), "0 00100100011 0 0 0 1000"),
        (Frame(0x7FF, bytes(2), False, True), "0 11111111111 1 0 0 0010"),
    ],
)
def test_headers_bit_by_bit(frame: Frame, bits: str) -> None:
    assert header_bits(frame) == [int(bit) for bit in bits.replace(" ", "")]


@given(st.integers(0, 0x7FF), st.binary(min_size=8, max_size=8))
@example(0x7FF, bytes(8))
@example(0, bytes(8))
def test_the_tables_find_the_same_length(identifier: int, data: bytes) -> None:
    assert plain_bits(identifier, data) == len(wire_bits(Frame(identifier, data))) + 3


def test_the_tables_refuse_the_same_identifiers() -> None:
    for identifier in (-1, 0x800):
        with pytest.raises(FrameError):
            plain_bits(identifier, bytes(8))


@pytest.mark.parametrize("place", range(7))
def test_a_run_goes_on_from_one_byte_into_the_next(place: int) -> None:
    for left in (0x57, 0x5F, 0xA8, 0xA0, 0x50):
        for right in (0xD5, 0xF5, 0x2A, 0x0A):
            data = bytearray(b"\x55" * 8)
            data[place : place + 2] = left, right
            bits = len(wire_bits(Frame(0x155, bytes(data)))) + 3
            assert plain_bits(0x155, bytes(data)) == bits


@pytest.mark.parametrize("last", range(0x40))
def test_a_run_goes_on_from_the_data_into_the_crc(last: int) -> None:
    data = b"\xaa" * 7 + bytes([last << 2 & 0xE0 | last & 0x1F])
    bits = len(wire_bits(Frame(0x2AA, data))) + 3
    assert plain_bits(0x2AA, data) == bits
