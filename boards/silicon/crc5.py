"""CRC-5 of EnDat: x^5 + x^3 + x + 1, start value and result inverted (hardware.md 3.1)."""

_POLYNOMIAL = 0x0B
"""x^5 + x^3 + x + 1, without its top bit."""
_INVERT = 0x1F


def crc5(bits: int, count: int) -> int:
    """CRC of the `count` lowest bits of `bits`, taken lowest first. The published vectors hold it to
    account."""
    crc = _INVERT
    for k in range(count):
        top = (crc >> 4) ^ (bits >> k & 1)
        crc = (crc << 1) & _INVERT
        if top:
            crc ^= _POLYNOMIAL
    return crc ^ _INVERT


def number(bits: list[int]) -> int:
    """Bits in transmission order as one integer, first bit lowest."""
    value = 0
    for bit in reversed(bits):
        value = value << 1 | bit
    return value


def crc_bits(bits: list[int]) -> list[int]:
    """The five bits that follow `bits` on the line, most significant first."""
    crc = crc5(number(bits), len(bits))
    return [crc >> shift & 1 for shift in range(4, -1, -1)]
