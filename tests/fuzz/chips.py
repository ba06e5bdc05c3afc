"""Attacks on the pins of chips: SPI transactions of the MCP2515, clock edges and bits of EnDat lines."""

from random import Random

from boards.chips.endat import ClockedEncoder, ClockedMaster, EndatError
from boards.chips.endat import registers as at
from boards.chips.endat.answer import crc_bits, value_of
from boards.chips.endat.encoder import Phase
from boards.chips.endat.master import checked
from boards.chips.endat.registers import MODES
from boards.chips.mcp2515 import Mcp2515
from boards.silicon.endat import check
from bus.can import Wire
from bus.time import EventQueue
from tests.fuzz import near
from tests.fuzz.left import counted

_LEAST = {0xC0: 1, 0x03: 3, 0x02: 3, 0x05: 4, 0xA0: 2, 0xB0: 2}
_LEAST |= dict.fromkeys(range(0x40, 0x46), 2) | dict.fromkeys((*range(0x90, 0x98, 2), *range(0x81, 0x88)), 1)
"""Bytes from which an instruction does or tells something (DS20001801 section 12): READ RX BUFFER frees its
buffer when chip select rises, whatever was read of it."""
_FRESH = 500
_MS = 1_000_000


class Rig:
    """A chip that always acknowledges and is answered; state() is all that SPI can see of it."""

    def __init__(self) -> None:
        self.queue = EventQueue()
        wire = Wire(self.queue)
        self.chip = Mcp2515(self.queue, wire.attach("chip"))
        self.heard: list[object] = []
        wire.attach("partner").on_receive = lambda _t, frame: self.heard.append(frame)

    def state(self) -> bytes:
        return bytes(self.chip.read(address) for address in range(0x80))


def spi(count: int, random: Random) -> dict[str, int]:
    """SPI, whole and bit by bit with a torn last byte: the same; no instruction, no change."""
    found = {"accepted": 0, "refused": 0}
    one, other = Rig(), Rig()
    for number in counted(count):
        if number % _FRESH == 0:
            one, other = Rig(), Rig()
        data = near.spi(random, [*_LEAST])
        known = len(data) >= _LEAST.get(data[0] if data else -1, 99)
        before = b"" if known else one.state()
        if one.chip.transfer(data) != _torn(other, data, random):
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
    for number in counted(count):
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


def edges(count: int, random: Random) -> dict[str, int]:
    """Eight edges of the clock at a time, most of them quick, now and then slow: the encoder is in a state it
    has, its data line high or low. After a rest it is an encoder again."""
    encoder = ClockedEncoder(lambda t_ns: t_ns)
    t_ns = 0
    for _ in counted(count):
        slowest = 3000 if random.random() < 0.9 else 60 * _MS
        for _ in range(8):
            t_ns += random.randrange(1, slowest)
            encoder.edge(t_ns, random.randrange(2), random.randrange(2))
            if encoder.level(t_ns) not in (0, 1) or encoder.phase not in tuple(Phase):
                raise AssertionError("a level or a phase that is none")
    encoder.edge(t_ns + 100 * _MS, 1, 0)
    encoder.edge(t_ns + 200 * _MS, 0, 0)
    if encoder.phase is not Phase.COMMAND:
        raise AssertionError("it takes no command after a rest")
    return {"accepted": count}


def bits(count: int, random: Random) -> dict[str, int]:
    """36 bits of noise: the fast check and the master's agree on CRC, position and alarm."""
    found = {"accepted": 0, "refused": 0}
    for _ in counted(count):
        line = [random.randrange(2) for _ in range(36)]
        crc = line[31:]
        position, alarm, good = check(value_of(line[30::-1]) | int("".join(map(str, crc)), 2) << 31)
        try:
            data = checked(line)
        except EndatError:
            data = []
        told = (value_of(data[:1:-1]), data[:2] != [0, 1]) if data else None
        if (told == (position, alarm)) != good or good != (crc_bits(line[:31]) == crc):
            raise AssertionError(f"{line}: one check takes it, the other does not")
        found["accepted" if good else "refused"] += 1
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
