"""Attacks on the pins of chips: SPI transactions of the MCP2515, clock edges and bits of an EnDat line."""

from __future__ import annotations

from random import Random

from boards.silicon.endat import ClockedEncoder, ClockedMaster, EndatError
from boards.silicon.endat import registers as at
from boards.silicon.endat.registers import MODES
from tests.boards.silicon.test_fuzz import Rig
from tests.fuzz import near

_LEAST = {0xC0: 1, 0x03: 3, 0x02: 3, 0x05: 4, 0xA0: 2, 0xB0: 2}
_LEAST |= dict.fromkeys(range(0x40, 0x46), 2) | dict.fromkeys((*range(0x90, 0x98, 2), *range(0x81, 0x88)), 1)
"""Bytes from which an instruction does or tells something (DS20001801 section 12): READ RX BUFFER frees its
buffer when chip select rises, whatever was read of it."""
_FRESH = 500
_MS = 1_000_000


def spi(count: int, random: Random) -> dict[str, int]:
    """SPI, whole and bit by bit with a torn last byte: the same; no instruction, no change."""
    found = {"accepted": 0, "refused": 0}
    one, other = Rig(), Rig()
    for number in range(count):
        if number % _FRESH == 0:
            one, other = Rig(), Rig()
        data = near.spi(random, [*_LEAST])
        known = len(data) >= _LEAST.get(data[0] if data else -1, 99)
        before = b"" if known else one.state()
        if one.whole(data) != _torn(other, data, random):
            raise AssertionError(f"{data.hex()}: bit by bit it is another answer")
        if not known and one.state() != before:
            raise AssertionError(f"{data.hex()} is no whole instruction and changed a register")
        step = random.randrange(50_000)
        for rig in (one, other):
            rig.queue.run_until(rig.queue.now_ns + step)
        if number % 100 == 99 and (one.state() != other.state() or one.heard != other.heard):
            raise AssertionError("the two chips are in two states")
        found["accepted" if known else "refused"] += 1
    return found


def _torn(rig: Rig, data: bytes, random: Random) -> bytes:
    """The transaction bit by bit, and up to seven bits more before chip select rises."""
    port = rig.chip.spi
    port.select()
    out = bytearray()
    for byte in data:
        value = 0
        for shift in range(7, -1, -1):
            value = value << 1 | port.clock(byte >> shift & 1)
        out.append(value)
    for _ in range(random.randrange(8)):
        port.clock(random.randrange(2))
    port.deselect()
    return bytes(out)


def endat(count: int, random: Random) -> dict[str, int]:
    """A torn transfer and noise on an EnDat line, a rest, and a position with one bit wrong or none: the
    position that the pin has, or EndatError."""
    found = {"accepted": 0, "refused": 0}
    encoder, master, t_ns = _line()
    for number in range(count):
        if number % _FRESH == 0:
            encoder, master, t_ns = _line()
        t_ns = _noise(encoder, t_ns, random)
        value = encoder.pin(0)
        wrong = random.randrange(-36, 36)
        master.line = lambda index, bit, wrong=wrong: bit ^ (index == wrong)  # type: ignore[misc]
        try:
            position = master.position(t_ns + 100 * _MS, at.SEND_POSITION_INFO)
        except EndatError:
            if wrong < 0:
                raise AssertionError("a sound transfer after a rest was refused") from None
            found["refused"] += 1
        else:
            if wrong >= 0 or position.value != value:
                raise AssertionError(f"bit {wrong} wrong, {value} on the pin, {position.value} accepted")
            found["accepted"] += 1
        t_ns = master.t_ns
    return found


def _line() -> tuple[ClockedEncoder, ClockedMaster, int]:
    encoder = ClockedEncoder(lambda _t: 0x12345678)
    return encoder, ClockedMaster(encoder), 0


def _noise(encoder: ClockedEncoder, t_ns: int, random: Random) -> int:
    """A command, mostly one that exists, for some clocks, with jumps of the clock; it ends high, at rest.

    Commands with an argument may write: they get no more clocks than their mode bits.
    """
    t_ns += 100 * _MS
    code = random.choice([*MODES, random.randrange(64)])
    plain = code not in MODES or not (MODES[code].argument or MODES[code].supplement)
    for number in range(random.randrange(80 if plain else 9)):
        bit = code >> (7 - number) & 1 if 2 <= number < 8 else random.randrange(2)
        for clock in (0, 1):
            t_ns += random.choice((1, 50, 500, 500, 500, 500, 12_000, 40_000))
            encoder.edge(t_ns, clock, bit)
            if encoder.level(t_ns) not in (0, 1):
                raise AssertionError("a level that is none")
    return t_ns
