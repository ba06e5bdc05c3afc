"""A frame bit by bit, as ISO 11898-1 writes it: slow and plain, the reference for the tables of `length`."""

from typing import Final

from bus.can.frame import Frame, check

CRC15_POLYNOMIAL: Final = 0x4599
"""x^15 + x^14 + x^10 + x^8 + x^7 + x^4 + x^3 + 1 without its top bit (CAN 2.0, 1991)."""
STUFF_RUN: Final = 5
"""After this many equal bits the transmitter inserts the opposite one."""
TAIL_BITS: Final = 1 + 1 + 1 + 7 + 3
"""CRC delimiter, ACK slot, ACK delimiter, end of frame, intermission: never stuffed."""
INTERMISSION_BITS: Final = 3


def crc15(bits: list[int]) -> int:
    """CRC-15 of `bits` in transmission order, initial value 0."""
    crc = 0
    for bit in bits:
        top = bit ^ (crc >> 14)
        crc = (crc << 1) & 0x7FFF
        if top:
            crc ^= CRC15_POLYNOMIAL
    return crc


def number_bits(value: int, count: int) -> list[int]:
    """`value` as `count` bits, most significant first."""
    return [value >> shift & 1 for shift in range(count - 1, -1, -1)]


def header_bits(frame: Frame) -> list[int]:
    """SOF, arbitration and control field, unstuffed. 0 is dominant."""
    length = number_bits(len(frame.data), 4)
    if not frame.extended:
        return [0, *number_bits(frame.identifier, 11), int(frame.remote), 0, 0, *length]
    base, rest = frame.identifier >> 18, frame.identifier & 0x3FFFF
    return [0, *number_bits(base, 11), 1, 1, *number_bits(rest, 18), int(frame.remote), 0, 0, *length]


def stuffed_field(frame: Frame) -> list[int]:
    """SOF to the end of the CRC, unstuffed: everything stuffing applies to."""
    check(frame)
    bits = header_bits(frame)
    if not frame.remote:
        for byte in frame.data:
            bits += number_bits(byte, 8)
    return bits + number_bits(crc15(bits), 15)


def stuff(bits: list[int]) -> list[int]:
    """Insert the opposite bit after every five equal ones; inserted bits count in the next run."""
    out: list[int] = []
    run, last = 0, -1
    for bit in bits:
        out.append(bit)
        run = run + 1 if bit == last else 1
        last = bit
        if run == STUFF_RUN:
            last = 1 - bit
            out.append(last)
            run = 1
    return out


def wire_bits(frame: Frame) -> list[int]:
    """All bits on the wire from SOF to the end of EOF as the transmitter sends them (ACK slot recessive)."""
    return stuff(stuffed_field(frame)) + [1] * (TAIL_BITS - INTERMISSION_BITS)
