"""CNF1-3 to bit rate and sample point, what is illegal, and what a wrong rate does to the bus (section 5)."""

import adafruit_mcp2515
import pytest

from boards.chips.mcp2515.bittiming import decode
from bus.can import Frame
from tests.boards.chips.mcp2515.bench import LISTEN, MS, Bench

TABLES = adafruit_mcp2515._BAUD_RATES
"""CNF1, CNF2, CNF3 by crystal and bit rate, as a driver in use has them: somebody else's arithmetic."""
NAMED = [(fosc, rate, cnf) for fosc, rates in TABLES.items() for rate, cnf in rates.items()]


def test_16_mhz_1_mbit() -> None:
    times = decode(16_000_000, 0x00, 0xD0, 0x82)
    assert (times.quanta, times.bitrate, times.sample_point, times.problems) == (8, 1e6, 0.625, ())
    assert (times.propagation, times.phase1, times.phase2, times.jump, times.triple) == (1, 3, 3, 1, True)


@pytest.mark.parametrize(("fosc", "rate", "cnf"), NAMED)
def test_every_triplet_of_a_driver_in_use_is_its_rate(
    fosc: int, rate: int, cnf: tuple[int, int, int]
) -> None:
    # 95k is 95238 (+0.25 %), 33k is 33333 (+1.0 %) (hardware.md 3.2), 666k is 666667, 83.3k is 83333
    tolerance = {33000: 0.0102, 95000: 0.0026, 666000: 0.0011, 83300: 0.0005}.get(rate, 1e-9)
    # For 10 MHz the driver (1.1.13) has prescalers of an 8 MHz crystal from 125k down: a quarter too fast.
    really = rate * 1.25 if fosc == 10_000_000 and rate <= 125_000 else rate
    assert decode(fosc, *cnf).bitrate == pytest.approx(really, rel=tolerance)


@pytest.mark.parametrize(
    ("cnf2", "phase2"),
    [(0x80, 3), (0x00, 2), (0x01, 2), (0x08, 2), (0x10, 3), (0x38, 8)],
)
def test_without_btlmode_phase_2_is_phase_1_or_the_processing_time(cnf2: int, phase2: int) -> None:
    assert decode(16_000_000, 0, cnf2, 2).phase2 == phase2


def test_the_prescaler_and_jump_width() -> None:
    times = decode(20_000_000, 0xC4, 0xBF, 0xC7)
    assert (times.brp, times.jump, times.quanta, times.triple) == (4, 4, 25, False)
    assert times.bitrate == 20_000_000 / (2 * 5 * 25)
    assert times.sample_point == 17 / 25


@pytest.mark.parametrize(
    ("fosc", "cnf", "words"),
    [
        (8_000_000, (0x00, 0x80, 0x80), {"PS2 is not longer", "processing time", "4 TQ per bit"}),
        (16_000_000, (0x00, 0x80, 0x06), {"shorter than PS2"}),
        (16_000_000, (0xC1, 0x9B, 0x02), {"PS2 is not longer"}),
        (16_000_000, (0xC1, 0x9B, 0x03), {"PS2 is not longer"}),
        (16_000_000, (0x81, 0x9B, 0x03), set()),
        (40_000_000, (0x00, 0xAC, 0x03), {"bit/s, CAN has at most"}),
        (16_000_008, (0x00, 0xD0, 0x82), {"bit/s, CAN has at most"}),  # half a bit a second too fast
        (20_000_000, (0x00, 0x9B, 0x01), set()),
        (16_000_000, (0x01, 0x89, 0x01), {"7 TQ per bit"}),
        (16_000_000, (0x00, 0x91, 0x01), set()),
        (16_000_000, (0x00, 0x90, 0x02), set()),
        (16_000_000, (0x00, 0x88, 0x03), {"shorter than PS2"}),
        (8_000_000, (0x00, 0x88, 0x02), {"7 TQ per bit"}),  # PropSeg + PS1 may equal PS2
    ],
)
def test_what_the_data_sheet_forbids_is_said(fosc: int, cnf: tuple[int, int, int], words: set[str]) -> None:
    problems = decode(fosc, *cnf).problems
    assert len(problems) == len(words), problems
    for each in words:
        assert any(each in problem for problem in problems), (each, problems)


def test_the_oscillator_tolerance_is_the_smaller_of_boschs_two() -> None:
    # 8 TQ, PS1 = PS2 = 3, SJW = 1: min(3 / 2 (104 - 3), 1 / 160) = 1 / 160 for each node
    timing = decode(16_000_000, 0x00, 0xD0, 0x82).wire_timing()
    assert timing.bit_ns == 1000
    assert (timing.sample_point, timing.jump) == (0.625, 0.125)
    assert timing.tolerance == pytest.approx(2 / 160)
    assert timing.fits(1012) and timing.fits(988.0) and not timing.fits(1014) and not timing.fits(986)
    wide = decode(16_000_000, 0xC1, 0x9B, 0x03).wire_timing()  # 13 TQ, SJW 4, PS1 = PS2 = 4
    assert wide.tolerance == pytest.approx(2 * min(4 / (2 * (13 * 13 - 4)), 4 / 260))


HALF, DOUBLE = (0x01, 0xD0, 0x82), (0x00, 0x89, 0x01)


@pytest.mark.parametrize(("fosc", "cnf"), [(16_000_000, (0x00, 0xD0, 0x82)), (32_000_000, HALF)])
def test_a_chip_at_twice_the_rate_destroys_what_others_send_until_it_is_passive(
    fosc: int, cnf: tuple[int, int, int]
) -> None:
    bench = Bench(bitrate=500_000, fosc_hz=fosc).start(cnf=cnf)
    third: list[Frame] = []
    bench.wire.attach("third").on_receive = lambda _t, frame: third.append(frame)
    bench.partner.send(Frame(0x123, bytes(8)), 0)
    bench.run(0.3)
    assert third == []
    assert bench.partner.tec > 0
    assert bench.read(0x2C) == 0x80
    assert bench.read(0x1D) > 0
    bench.run(10)
    assert bench.read(0x2D) & 0x08  # passive: from here on it only misses the frames
    assert third == [Frame(0x123, bytes(8))]
    assert bench.read(0x2C) & 3 == 0


def test_a_chip_at_half_the_rate_understands_nothing() -> None:
    # Five equal bits and a stuff bit look like three bits to it: it sees its error after the frame's end.
    bench = Bench().start(cnf=HALF)
    bench.wire.attach("third")
    bench.partner_sends(Frame(0x123, bytes(8)))
    assert bench.read(0x2C) == 0x80
    assert bench.read(0x1D) == 1


@pytest.mark.parametrize("cnf", [HALF, (0x00, 0x88, 0x01)])
def test_a_chip_that_sends_at_another_rate_goes_off(cnf: tuple[int, int, int]) -> None:
    bench = Bench(bitrate=500_000 if cnf != HALF else 1_000_000).start(cnf=cnf)
    bench.wire.attach("third")
    bench.load(0, 0x123, bytes(range(8)))
    bench.spi(0x81)
    went_off = False
    for _ in range(400):
        bench.run(0.05)
        went_off |= bool(bench.read(0x2D) & 0x20)
    assert went_off
    assert bench.heard == []
    assert bench.partner.rec > 0


def test_a_listen_only_chip_at_a_wrong_rate_harms_nobody() -> None:
    bench = Bench().start(LISTEN, cnf=HALF)
    third: list[Frame] = []
    bench.wire.attach("third").on_receive = lambda _t, frame: third.append(frame)
    bench.partner_sends(Frame(0x123, bytes(8)))
    assert len(third) == 1
    assert bench.partner.tec == 0
    assert bench.read(0x2C) == 0x80


def test_two_chips_at_a_rate_of_their_own_understand_each_other() -> None:
    one = Bench()
    one.wire.detach(one.partner)
    from boards.chips.mcp2515 import Mcp2515

    other = Mcp2515(one.queue, one.wire.attach("other"))
    for chip in (one.chip, other):
        chip.transfer(bytes((0x02, 0x28, 0x82, 0xD0, 0x01)))
        chip.transfer(bytes((0x02, 0x60, 0x60)))
        chip.transfer(bytes((0x02, 0x0F, 0x00)))
    one.load(0, 0x123, b"\x01")
    one.spi(0x81)
    one.run(1)
    assert other.transfer(bytes((0x90, 0, 0, 0, 0, 0, 0)))[1:] == bytes((0x24, 0x60, 0, 0, 1, 1))
    assert one.wire.bits == pytest.approx(2 * 59, abs=10)  # 47 + 8 bits and stuffing, at half the rate
    assert one.queue.now_ns == MS


def test_a_crystal_within_tolerance_is_heard() -> None:
    bench = Bench(fosc_hz=16_080_000).start()  # + 0.5 %
    bench.partner_sends(Frame(0x123, b"\x01"))
    assert bench.read(0x2C) == 1
