"""Exact length of a frame on the wire from tables: what every frame costs, so it has to be quick.

CRC-15 is linear, so the CRC of an eight-byte frame is the header's share XOR one table entry per byte.
Stuffing is a state machine of nine states (nothing yet; last bit and run of 1..4), tabulated for 16 bits at a
time. An entry is one byte: new state in bits 0..3, inserted stuff bits in bits 4..6. Built once with numpy,
0.9 MB in all. `bits.py` is the reference it is tested against.
"""

from typing import Final

import numpy as np
from numpy.typing import NDArray

from bus.can.bits import CRC15_POLYNOMIAL, TAIL_BITS, crc15, header_bits, stuff, stuffed_field
from bus.can.frame import MAX_STANDARD, Frame, check

_STATES: Final = 9
_START: Final = 0
"""State 0, "nothing yet", is never reached by a bit. 1 + 4 * last + (run - 1), run 1..4, gives 1..8."""


def _step(state: int, bit: int) -> tuple[int, int]:
    """New state and inserted bits (0 or 1) when `bit` follows in `state`."""
    last, run = divmod(state - 1, 4) if state else (-1, -1)
    if bit != last:
        return 1 + 4 * bit, 0
    if run == 3:  # the fifth equal bit: the inserted opposite one starts a run of its own
        return 1 + 4 * (1 - bit), 1
    return state + 1, 0


def _machine(bits: int) -> NDArray[np.uint8]:
    """The stuffing machine over all values of `bits` bits: array [state, value] -> state | inserted << 4."""
    steps = [[_step(state, bit) for bit in (0, 1)] for state in range(_STATES)]
    single = np.array([[after | inserted << 4 for after, inserted in row] for row in steps])
    table = np.arange(_STATES)[:, None]
    for _ in range(bits):
        after = single[table & 15]
        table = (after + (table >> 4 << 4)[:, :, None]).reshape(_STATES, -1)
    return table.astype(np.uint8)


def _shares() -> list[list[int]]:
    """CRC-15 share of each of the eight bytes of a frame: [byte number][value]."""
    values = np.arange(1 << 8)
    crc = np.zeros(1 << 8, dtype=np.int64)
    shares: list[list[int]] = []
    for _ in range(8):
        for shift in range(7, -1, -1):
            bit = values >> shift & 1 if not shares else 0
            top = (crc >> 14 ^ bit) & 1
            crc = crc << 1 & 0x7FFF ^ top * CRC15_POLYNOMIAL
        shares.append(crc.tolist())
    return shares[::-1]


_STUFF_WORD: Final = _machine(16).tobytes()
_STUFF_CRC: Final = _machine(15).tobytes()
"""Rows follow one another. The entry of state s and value v is at s << 16 | v, or s << 15 | v for the CRC."""
_BYTES: Final = _shares()
_BYTE0: Final = _BYTES[0]
_BYTE1: Final = _BYTES[1]
_BYTE2: Final = _BYTES[2]
_BYTE3: Final = _BYTES[3]
_BYTE4: Final = _BYTES[4]
_BYTE5: Final = _BYTES[5]
_BYTE6: Final = _BYTES[6]
_BYTE7: Final = _BYTES[7]

_packed: Final = [0] * (MAX_STANDARD + 1)
"""What `_header` found, per standard identifier; 0: not found yet."""


def _header(identifier: int) -> int:
    """Of an eight-byte standard data frame's header: CRC share, stuffing state << 16, bits so far (tail and
    CRC included) << 24."""
    frame = Frame(identifier, bytes(8))
    check(frame)
    bits = header_bits(frame)
    state, inserted = _START, 0
    for bit in bits:
        state, more = _step(state, bit)
        inserted += more
    _packed[identifier] = found = (
        len(bits) + inserted + 64 + 15 + TAIL_BITS << 24 | state << 16 | crc15(bits + [0] * 64)
    )
    return found


def frame_bits(frame: Frame) -> int:
    """Bits `frame` takes on the wire, stuff bits and the three bits of intermission included.

    Raises FrameError when CAN 2.0 cannot carry the frame.
    """
    if len(frame.data) != 8 or frame.extended or frame.remote:
        return len(stuff(stuffed_field(frame))) + TAIL_BITS  # bit by bit
    return plain_bits(frame.identifier, frame.data)


def plain_bits(identifier: int, data: bytes) -> int:
    """The same for the frames that there are most of: standard identifier, eight bytes."""
    head = _packed[identifier] if 0 <= identifier <= MAX_STANDARD else 0
    if not head:
        head = _header(identifier)
    p, q, r, s, t, u, v, w = (
        data[0], data[1], data[2], data[3], data[4], data[5], data[6], data[7],
    )  # fmt: skip
    crc = head & 0x7FFF
    crc ^= _BYTE0[p] ^ _BYTE1[q] ^ _BYTE2[r] ^ _BYTE3[s] ^ _BYTE4[t] ^ _BYTE5[u] ^ _BYTE6[v] ^ _BYTE7[w]
    table = _STUFF_WORD
    e = table[head & 0xF_0000 | p << 8 | q]
    f = table[(e & 15) << 16 | r << 8 | s]
    g = table[(f & 15) << 16 | t << 8 | u]
    h = table[(g & 15) << 16 | v << 8 | w]
    i = _STUFF_CRC[(h & 15) << 15 | crc]
    return (head >> 24) + (e >> 4) + (f >> 4) + (g >> 4) + (h >> 4) + (i >> 4)
