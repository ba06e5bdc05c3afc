"""What a receiver makes of wrong bits, against a receiver written another way: on text, with regular
expressions and long division (ISO 11898-1: frame formats, bit stuffing, error detection)."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from bus.can import Frame
from bus.can.bits import TAIL_BITS, stuff, wire_bits
from bus.can.disturbance import Verdict, first_difference, overloads, receive, seen_by_all, seen_by_receiver

GENERATOR = 0b1100010110011001
"""x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1 (ISO 11898-1)."""
STUFF_BIT = re.compile("(?<=00000)1|(?<=11111)0")
FRAMES = [
    Frame(0x123, bytes.fromhex("0102030405060708")),
    Frame(0x7FF, b""),
    Frame(0x555, b"\xaa\x00\xff", False, True),
    Frame(0x000, bytes(8)),
    Frame(0x0AAAAAAA, b"\x5a", True),
    Frame(0x1FFFFFFF, b"\xff\x00", True, True),
    Frame(0x00000001, bytes(8), True),
    Frame(0x0F0, b"\x0f"),
    Frame(0x0AAAAAA0 | 1 << 4, b"\x0f", True),
]
"""Base and extended, data and remote; runs of either level; the last two have a stuff bit behind RTR."""


def remainder(bits: str) -> int:
    """Of the polynomial that `bits` are, divided by the generator: 0 for a message with its right CRC."""
    value = int(bits, 2)
    while value.bit_length() > 15:
        value ^= GENERATOR << (value.bit_length() - 16)
    return value


def needed(plain: str) -> int:
    """Bits from SOF to the end of the CRC of the frame that begins so; more than there are while open."""
    extended = plain[13:14] == "1"
    code, remote = (plain[35:39], plain[32:33]) if extended else (plain[15:19], plain[12:13])
    if len(code) < 4:
        return 1 << 30
    return (39 if extended else 19) + (0 if remote == "1" else 8 * min(int(code, 2), 8)) + 15


def by_text(bits: list[int]) -> tuple[str, int] | None:
    """Kind of error and the bit it is detected at, as a receiver sees it; None: the frame is taken."""
    start = bits.index(0)
    text = "".join(map(str, bits[start:])) + "1" * 20
    for end in range(1, len(text)):
        if re.search("0{6}|1{6}", text[:end]):
            return "stuff", start + end - 1
        plain = STUFF_BIT.sub("", text[:end])
        if len(plain) == needed(plain) and not re.search("(0{5}|1{5})$", text[:end]):
            break
    if text[end] == "0":  # CRC delimiter
        return "form", start + end
    if remainder(plain):  # flagged after the ACK delimiter
        return "crc", start + end + 2
    wrong = text[end + 2 : end + 9].find("0")  # ACK delimiter and the first six bits of EOF
    return None if wrong < 0 else ("form", start + end + 2 + wrong)


def acknowledged(frame: Frame) -> list[int]:
    bits = wire_bits(frame)
    bits[-9] = 0  # ACK slot: EOF is 7 bits, ACK delimiter 1
    return bits


@pytest.mark.parametrize("frame", FRAMES, ids=str)
def test_every_bit_wrong_at_one_receiver(frame: Frame) -> None:
    good = acknowledged(frame)
    assert receive(good) is None and by_text(good) is None
    for bit in range(len(good)):
        wrong = list(good)
        wrong[bit] ^= 1
        found = seen_by_receiver(frame, bit)
        assert (found and (found.kind, found.detected_bit)) == by_text(wrong), bit
        assert found is None or found[2:] == ("transmits", False)
    assert seen_by_receiver(frame, -1) is None and seen_by_receiver(frame, len(good)) is None


@given(st.lists(st.integers(0, 1), min_size=1, max_size=160).map(lambda rest: [0, *rest]))
def test_any_bits_at_all(bits: list[int]) -> None:
    found = receive(bits)
    assert (found and (found.kind, found.detected_bit)) == by_text(bits)


@pytest.mark.parametrize("code", range(9, 16))
@pytest.mark.parametrize("extended", [False, True])
def test_a_length_code_above_eight_means_eight_bytes(code: int, extended: bool) -> None:
    head = "0" + "01010101010" + ("11" + "101010101010101010" + "000" if extended else "000")
    plain = head + f"{code:04b}" + "01100110" * 8
    plain += f"{remainder(plain + '0' * 15):015b}"
    bits = [*stuff([int(bit) for bit in plain]), 1, 0, 1, *[1] * 7]
    assert receive(bits) is None
    bits[-11] ^= 1  # last bit of the CRC or a stuff bit behind it
    assert receive(bits) is not None


def arbitration(frame: Frame) -> tuple[str, int]:
    """The wire as text and the index of RTR: the 13th bit of a base frame, the 33rd of an extended one."""
    text = "".join(map(str, wire_bits(frame)))
    wanted = 33 if frame.extended else 13
    return text, next(k for k in range(len(text)) if len(STUFF_BIT.sub("", text[: k + 1])) == wanted)


@pytest.mark.parametrize("frame", FRAMES, ids=str)
def test_every_bit_wrong_on_the_wire_is_the_error_of_its_place(frame: Frame) -> None:
    """A recessive bit of the arbitration field that is overwritten is lost arbitration: the bus then stays
    recessive and the sixth such bit is a stuff error (receivers count); if it was a stuff bit, it is a stuff
    error at once that counts for no transmitter. Everywhere else the sender sees its own bit wrong."""
    text, rtr = arbitration(frame)
    delimiter = len(text) - 10
    for bit, level in enumerate(text):
        found = seen_by_all(frame, bit)
        if bit <= rtr and level == "1":
            stuffed = text[:bit].endswith("00000")
            wanted = Verdict("stuff", bit, "spared") if stuffed else Verdict("stuff", bit + 6, "lost")
        elif bit < delimiter:
            wanted = Verdict("bit", bit)
        elif bit == delimiter + 1:
            wanted = Verdict("ack", bit)
        else:
            wanted = Verdict("form", bit, received=bit == len(text) - 1)
        assert found == wanted, bit
        assert overloads(frame, bit) == (bit == len(text) - 1)
    assert seen_by_all(frame, -1) is None and seen_by_all(frame, len(text)) is None
    assert len(text) == len(wire_bits(frame)) and TAIL_BITS == 13  # delimiters, ACK, EOF, intermission


def test_where_two_senders_part() -> None:
    assert first_difference([0, 1, 0], [0, 1, 0]) is None
    assert first_difference([0, 1, 0], [0, 0, 1]) == (1, True)
    assert first_difference([0, 0, 1], [0, 1, 0]) == (1, False)
    assert first_difference([0, 1], [0, 1, 1]) is None
