"""Fuzz of SPI and EnDat lines: nothing crashes or hangs, and whole, by bytes and by bits come out the same.

10^4 inputs here; 10^6 by `SCHMIDT_FUZZ=1000000 python -m pytest tests/boards/silicon/test_fuzz.py`.
"""

import os

import numpy as np

from boards.silicon.endat import ClockedEncoder, EndatError, check
from boards.silicon.endat.crc import crc_bits, number
from boards.silicon.endat.encoder import Phase
from boards.silicon.endat.master import checked
from boards.silicon.mcp2515 import Mcp2515
from bus.can import Wire
from bus.time import EventQueue

INPUTS = int(os.environ.get("SCHMIDT_FUZZ", "10000"))
_FIRST = (*(0xC0, 3, 2, 5, 0xA0, 0xB0), *range(0x90, 0x98, 2), *range(0x40, 0x46), *range(0x80, 0x88))


class Rig:
    """A chip that always acknowledges and is answered; state() is all that SPI can see of it."""

    def __init__(self) -> None:
        self.queue = EventQueue()
        self.wire = Wire(self.queue)
        self.chip = Mcp2515(self.queue, self.wire.attach("chip"))
        self.partner = self.wire.attach("partner")
        self.heard: list[object] = []
        self.partner.on_receive = lambda _t, frame: self.heard.append(frame)

    def whole(self, data: bytes) -> bytes:
        return self.chip.transfer(data)

    def bitwise(self, data: bytes) -> bytes:
        spi = self.chip.spi
        spi.select()
        out = bytearray()
        for byte in data:
            value = 0
            for shift in range(7, -1, -1):
                value = value << 1 | spi.clock(byte >> shift & 1)
            out.append(value)
        spi.deselect()
        return bytes(out)

    def state(self) -> bytes:
        return bytes(self.chip.read(address) for address in range(0x80))


def transaction(draw: np.random.Generator) -> bytes:
    """Half pure noise, half an instruction that exists with noise behind it."""
    noise = draw.integers(0, 256, draw.integers(0, 18)).astype(np.uint8).tobytes()
    if draw.random() < 0.5 or not noise:
        return noise
    return bytes((_FIRST[draw.integers(len(_FIRST))],)) + noise[1:]


def test_spi_takes_anything_whole_or_bit_by_bit() -> None:
    draw = np.random.default_rng(2515)
    one, other = Rig(), Rig()
    for count in range(INPUTS):
        if count % 500 == 0:
            one, other = Rig(), Rig()
        data = transaction(draw)
        assert one.whole(data) == other.bitwise(data)
        step = int(draw.integers(0, 50_000))
        for rig in (one, other):
            rig.queue.run_until(rig.queue.now_ns + step)
        if count % 100 == 99:
            assert one.state() == other.state()
            assert one.heard == other.heard


def test_endat_encoder_takes_any_edges() -> None:
    draw = np.random.default_rng(29)
    encoder = ClockedEncoder(lambda t_ns: t_ns)
    t_ns = 0
    for _ in range(INPUTS):
        steps = draw.integers(1, 3000, 8) if draw.random() < 0.9 else draw.integers(1, 60_000_000, 8)
        for step, clock, data in zip(steps, draw.integers(0, 2, 8), draw.integers(0, 2, 8), strict=True):
            t_ns += int(step)
            encoder.edge(t_ns, int(clock), int(data))
            assert encoder.level(t_ns) in (0, 1)
            assert encoder.phase in tuple(Phase)
    # and it is still an encoder
    encoder.edge(t_ns + 100_000_000, 1, 0)
    t_ns += 200_000_000
    encoder.edge(t_ns, 0, 0)
    assert encoder.phase is Phase.COMMAND


def test_any_endat_bits_are_accepted_or_refused_and_both_checks_agree() -> None:
    draw = np.random.default_rng(5)
    accepted = 0
    for _ in range(INPUTS):
        bits = [int(bit) for bit in draw.integers(0, 2, 36)]
        crc = bits[31:]
        frame = number(bits[:31]) | int("".join(map(str, crc)), 2) << 31
        position, alarm, good = check(frame)
        try:
            data = checked(bits)
        except EndatError:
            assert not good
            continue
        accepted += 1
        assert good
        assert crc_bits(bits[:31]) == crc
        assert (position, alarm) == (number(data[2:]), data[:2] != [0, 1])
    assert 0.5 < accepted / (INPUTS / 32) < 1.5  # noise passes a CRC of five bits once in 32
