"""Priorities, abort, one shot, errata (DS20001801 section 3, DS80179G)."""

import itertools

import pytest

from bus.can import Flip, Frame
from tests.boards.chips.mcp2515.bench import CONFIG, LISTEN, LOOPBACK, MS, NORMAL, SLEEP, Bench

TXREQ, TXERR, MLOA, ABTF = 0x08, 0x10, 0x20, 0x40
TXCTRL = (0x30, 0x40, 0x50)
ABAT, OSM = 0x10, 0x08


@pytest.mark.parametrize("txp", list(itertools.product(range(4), repeat=3)))
def test_the_highest_txp_goes_first_and_ties_go_to_the_highest_buffer(txp: tuple[int, int, int]) -> None:
    bench = Bench().start()
    for buffer in range(3):
        bench.load(buffer, 0x100 + buffer, txp=txp[buffer])
    bench.spi(0x87)
    bench.run()
    order = sorted(range(3), key=lambda n: (txp[n], n), reverse=True)
    assert [frame.identifier - 0x100 for frame in bench.heard] == order
    assert bench.read(0x2C) == 0x1C
    assert [bench.read(address) for address in TXCTRL] == list(txp)


def test_a_buffer_of_higher_priority_overtakes_one_that_has_not_begun() -> None:
    bench = Bench().start()
    bench.partner.send(Frame(0, bytes(8)), bench.queue.now_ns)
    bench.run(0.02)
    bench.load(0, 0x100, txp=1)
    bench.spi(0x81)
    bench.load(1, 0x200, txp=2)
    bench.spi(0x82)
    bench.load(2, 0x300, txp=0)
    bench.spi(0x84)
    bench.spi(0x05, 0x50, 3, 3)  # TXP may change while it waits
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x300, 0x200, 0x100]


def test_one_on_the_bus_is_not_overtaken() -> None:
    bench = Bench().start()
    bench.load(0, 0x100, bytes(8))
    bench.load(2, 0x300, txp=3)
    bench.spi(0x81)
    bench.run(0.03)
    bench.spi(0x84)
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x100, 0x300]


@pytest.mark.parametrize(
    ("image", "frame"),
    [
        ((0xFF, 0xE0, 0, 0, 0), Frame(0x7FF, b"")),
        ((0x24, 0x60, 0xFF, 0xFF, 2, 7, 8), Frame(0x123, b"\x07\x08")),
        ((0x24, 0x60, 0, 0, 0x0F, *range(8)), Frame(0x123, bytes(range(8)))),
        ((0x24, 0x60, 0, 0, 0x43, 1, 2, 3), Frame(0x123, bytes(3), remote=True)),
        ((0x00, 0x28, 0x00, 0x01, 1, 9), Frame(1 << 18 | 1, b"\x09", extended=True)),
        ((0xFF, 0xEB, 0xFF, 0xFE, 0x40), Frame(0x1FFFFFFE, b"", extended=True, remote=True)),
        ((0x12, 0x4A, 0x34, 0x56, 0), Frame(0x92 << 18 | 0x23456, b"", extended=True)),
    ],
)
def test_a_buffer_is_the_frame_its_bytes_say(image: tuple[int, ...], frame: Frame) -> None:
    bench = Bench().start()
    bench.spi(0x44, *image)
    bench.spi(0x84)
    bench.run()
    assert bench.heard == [frame]
    assert bench.read(0x55) == image[4]


def test_a_request_is_cleared_and_flagged_when_the_frame_is_through() -> None:
    bench = Bench().start()
    bench.write(0x2B, 0x08)
    bench.load(1, 0x123)
    bench.spi(0x05, 0x40, TXREQ, TXREQ)
    assert bench.read(0x40) == TXREQ
    assert bench.spi(0xA0, 0)[1] == 0b00010000
    bench.run(0.05)
    assert bench.read(0x40) == 0
    assert bench.read(0x2C) == 0x08
    assert bench.read(0x0E) == 0x08  # ICOD 4
    assert bench.pin == [True]
    bench.write(0x2C, 0)
    assert bench.pin == [True, False]


def test_taking_a_request_back_before_the_bus_is_free_sends_nothing() -> None:
    bench = Bench().start()
    bench.partner.send(Frame(0, bytes(8)), bench.queue.now_ns)
    bench.run(0.02)
    bench.load(0, 0x100)
    bench.load(1, 0x101)
    bench.spi(0x83)
    bench.spi(0x05, 0x30, TXREQ, 0)
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x101]
    assert bench.read(0x30) == 0  # no ABTF: that is for ABAT
    assert bench.read(0x2C) & 0x1C == 0x08


def test_abat_aborts_what_waits_and_spares_what_is_on_the_bus() -> None:
    bench = Bench().start()
    for buffer in range(3):
        bench.load(buffer, 0x100 + buffer, bytes(8))
    bench.spi(0x87)
    bench.run(0.03)  # buffer 2 is on the bus
    bench.spi(0x05, 0x0F, ABAT, ABAT)
    assert [bench.read(address) for address in TXCTRL] == [ABTF, ABTF, TXREQ]
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x102]
    assert [bench.read(address) for address in TXCTRL] == [ABTF, ABTF, 0]
    bench.spi(0x81)
    assert bench.read(0x30) == ABTF  # as long as ABAT stands, nothing is sent
    bench.run()
    assert len(bench.heard) == 1
    bench.spi(0x05, 0x0F, ABAT, 0)
    bench.spi(0x81)
    assert bench.read(0x30) == TXREQ
    bench.run()
    assert len(bench.heard) == 2


def test_abat_marks_no_buffer_that_did_not_wait() -> None:
    bench = Bench().start()
    bench.spi(0x05, 0x0F, ABAT, ABAT)
    assert [bench.read(address) for address in TXCTRL] == [0, 0, 0]


def test_one_on_the_bus_that_fails_after_its_abort_is_not_tried_again() -> None:
    for how in ("abat", "txreq"):
        bench = Bench().start()
        bench.wire.disturb(lambda _t, _f, _s: Flip(40))
        bench.load(0, 0x100, bytes(8))
        bench.spi(0x81)
        bench.run(0.03)
        if how == "abat":
            bench.spi(0x05, 0x0F, ABAT, ABAT)
            assert bench.read(0x30) == TXREQ
        else:
            bench.spi(0x05, 0x30, TXREQ, 0)
            assert bench.read(0x30) == 0
        bench.run()
        assert bench.heard == []
        assert bench.read(0x30) == TXERR | (ABTF if how == "abat" else 0)
        assert sum(bench.wire.errors.values()) == 1
        assert bench.read(0x2C) == 0x80
        assert bench.read(0x1C) == 8


def test_a_disturbed_frame_is_sent_again_and_says_so() -> None:
    bench = Bench().start()
    flips = [Flip(40), Flip(30), None]
    bench.wire.disturb(lambda _t, _f, _s: flips.pop(0))
    bench.load(0, 0x100, bytes(8))
    bench.spi(0x81)
    bench.run(0.1)
    assert bench.read(0x30) == TXREQ | TXERR
    assert bench.read(0x2C) == 0x80
    bench.run()
    assert len(bench.heard) == 1
    assert bench.read(0x30) == TXERR
    assert bench.read(0x2C) == 0x84
    assert bench.read(0x1C) == 15
    bench.wire.disturb(None)
    bench.spi(0x81)
    assert bench.read(0x30) == TXREQ


def test_one_shot_sends_once_whatever_becomes_of_it() -> None:
    bench = Bench().start()
    bench.spi(0x05, 0x0F, OSM, OSM)
    bench.wire.disturb(lambda _t, _f, _s: Flip(40))
    bench.load(0, 0x100, bytes(8))
    bench.spi(0x81)
    bench.run()
    assert bench.read(0x30) == TXERR
    assert sum(bench.wire.errors.values()) == 1
    bench.wire.disturb(None)
    bench.load(1, 0x101)
    bench.partner.send(Frame(0x001, b""), bench.queue.now_ns)
    bench.spi(0x82)
    bench.run()
    assert bench.read(0x40) == MLOA
    assert bench.heard == []
    bench.spi(0x82)
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x101]


def test_a_lost_arbitration_is_marked_and_tried_again() -> None:
    bench = Bench().start()
    bench.load(0, 0x101)
    bench.partner.send(Frame(0x100, b""), bench.queue.now_ns)
    bench.spi(0x81)
    bench.run(0.05)
    assert bench.read(0x30) == MLOA | TXREQ
    bench.run()
    assert bench.read(0x30) == MLOA
    assert [frame.identifier for frame in bench.heard] == [0x101]
    assert bench.read(0x60) & 0x08 == 0


def test_after_a_lost_arbitration_the_priorities_count_again() -> None:
    bench = Bench().start()
    bench.load(0, 0x101)
    bench.load(1, 0x102, txp=3)
    bench.partner.send(Frame(0x100, b""), bench.queue.now_ns)
    bench.spi(0x81)
    bench.run(0.02)
    bench.spi(0x82)
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x102, 0x101]


def test_a_request_made_before_normal_mode_waits_for_it() -> None:
    bench = Bench()
    bench.load(0, 0x101)
    bench.spi(0x81)
    bench.start(LISTEN)
    bench.run()
    assert bench.heard == []
    bench.mode(NORMAL)
    bench.run()
    assert len(bench.heard) == 1


@pytest.mark.parametrize("mode", [CONFIG, SLEEP, LISTEN, LOOPBACK])
def test_the_mode_changes_once_nothing_waits(mode: int) -> None:
    bench = Bench().start()
    bench.load(0, 0x101)
    bench.load(1, 0x102)
    bench.spi(0x83)
    bench.mode(mode)
    assert bench.read(0x0E) & 0xE0 == NORMAL
    assert bench.read(0x0F) & 0xE0 == mode
    bench.run(0.07)
    assert len(bench.heard) == 1
    assert bench.read(0x0E) & 0xE0 == NORMAL
    bench.run()
    assert len(bench.heard) == 2
    assert bench.read(0x0E) & 0xE0 == mode


def test_a_mode_asked_for_comes_when_the_last_request_is_given_up() -> None:
    for how in ("txreq", "abat", "one shot", "reset"):
        bench = Bench().start()
        bench.partner.online = False
        bench.load(0, 0x101)
        bench.spi(0x81)
        bench.run(0.3)
        bench.mode(CONFIG)
        bench.run(3)
        assert bench.read(0x0E) & 0xE0 == NORMAL  # nobody acknowledges: it would wait for ever
        if how == "txreq":
            bench.spi(0x05, 0x30, TXREQ, 0)
        elif how == "abat":
            bench.spi(0x05, 0x0F, ABAT, ABAT)
        elif how == "one shot":
            bench.spi(0x05, 0x0F, OSM, OSM)
        else:
            bench.spi(0xC0)
        bench.run()
        assert bench.read(0x0E) & 0xE0 == CONFIG, how


@pytest.mark.parametrize("errata", [False, True])
@pytest.mark.parametrize("selected", [False, True])
@pytest.mark.parametrize("instruction", [(0x82,), (0x02, 0x40, 0x08)])
def test_a_request_kept_selected_is_sent_twice_by_errata(
    errata: bool, selected: bool, instruction: tuple[int, ...]
) -> None:
    bench = Bench(errata=errata).start()
    bench.load(1, 0x123)
    spi = bench.chip.spi
    spi.select()
    for byte in instruction:
        spi.exchange(byte)
    if not selected:
        spi.deselect()
    bench.run(3)
    spi.deselect()
    assert len(bench.heard) == (2 if errata and selected else 1)


def test_a_mode_comes_at_once_when_a_request_that_still_waits_is_taken_back() -> None:
    bench = Bench().start()
    bench.partner.send(Frame(0, bytes(8)), bench.queue.now_ns)
    bench.run(0.02)
    bench.load(0, 0x101)
    bench.spi(0x81)
    bench.mode(CONFIG)
    assert bench.read(0x0E) & 0xE0 == NORMAL
    bench.spi(0x05, 0x30, TXREQ, 0)
    assert bench.read(0x0E) & 0xE0 == CONFIG


def test_a_mode_comes_with_the_lost_arbitration_of_one_shot() -> None:
    bench = Bench().start()
    bench.write(0x0F, OSM)
    bench.load(0, 0x101)
    bench.partner.send(Frame(0x100, b""), bench.queue.now_ns)
    bench.spi(0x81)
    bench.mode(CONFIG)
    assert bench.read(0x0E) & 0xE0 == NORMAL
    bench.run(0.02)  # 12 bits of identifier, the frame has 47
    assert bench.read(0x0E) & 0xE0 == CONFIG


def test_loop_back_reaches_nobody_but_the_chip_and_takes_its_time() -> None:
    bench = Bench().start(LOOPBACK)
    for buffer in range(2):
        bench.load(buffer, 0x100 + buffer, bytes(8), txp=1 - buffer)
    bench.write(0x60, 0x64)
    bench.spi(0x83)
    bench.run(0.1)
    assert bench.read(0x2C) == 0
    assert bench.read(0x30) == TXREQ | 1
    bench.run(0.04)  # 111..135 bits at 1 Mbit/s
    assert bench.read(0x2C) == 0x05
    bench.run(0.14)
    assert bench.read(0x2C) == 0x0F
    assert bench.heard == []
    assert bench.wire.frames == 0
    assert bench.spi(0x90, 0, 0)[1:] == [0x20, 0x00]
    assert bench.spi(0x94, 0, 0)[1:] == [0x20, 0x20]


def test_leaving_loop_back_by_reset_forgets_the_frame_in_flight() -> None:
    bench = Bench().start(LOOPBACK)
    bench.load(0, 0x100)
    bench.spi(0x81)
    bench.run(0.01)
    bench.spi(0xC0)
    bench.start(LOOPBACK)
    bench.run()
    assert bench.read(0x2C) == 0


def test_a_reset_in_the_middle_of_a_frame_cuts_it_off() -> None:
    bench = Bench().start()
    bench.load(0, 0x100, bytes(8))
    bench.spi(0x81)
    bench.run(0.03)
    bench.spi(0xC0)
    bench.run()
    assert bench.heard == []
    assert bench.wire.errors == {"stuff": 1}
    assert bench.queue.now_ns > MS


def test_by_errata_only_a_request_counts_not_any_write() -> None:
    bench = Bench(errata=True).start()
    bench.load(1, 0x123)
    bench.spi(0x82)
    spi = bench.chip.spi
    spi.select()
    for byte in (0x02, 0x30, 0x01):
        spi.exchange(byte)
    bench.run()
    spi.deselect()
    bench.load(0, 0x124)
    spi.select()
    for byte in (0x02, 0x40, 0x00):
        spi.exchange(byte)
    bench.run()
    spi.deselect()
    assert [frame.identifier for frame in bench.heard] == [0x123]


def test_what_became_of_a_request_stands_until_the_next_one() -> None:
    """MLOA, ABTF: a write of TXP alone leaves them (DS20001801, TXBnCTRL bits 6 to 4)."""
    for status, act in ((MLOA, (0x05, 0x0F, OSM, OSM)), (ABTF, (0x05, 0x0F, ABAT, ABAT))):
        bench = Bench().start()
        bench.spi(*act)
        bench.load(0, 0x101)
        bench.partner.send(Frame(0x100, b""), bench.queue.now_ns)
        bench.spi(0x81)
        bench.run()
        assert bench.read(0x30) == status
        bench.spi(0x05, 0x30, 3, 2)
        assert bench.read(0x30) == status | 2
        bench.spi(0x05, 0x0F, ABAT, 0)
        bench.spi(0x81)
        assert bench.read(0x30) == TXREQ | 2


def test_a_request_taken_back_before_abat_is_not_one_that_abat_took() -> None:
    bench = Bench().start()
    bench.wire.disturb(lambda _t, _f, _s: Flip(40))
    bench.load(0, 0x100, bytes(8))
    bench.spi(0x81)
    bench.run(0.03)  # it is on the bus
    bench.spi(0x05, 0x30, TXREQ, 0)
    bench.spi(0x05, 0x0F, ABAT, ABAT)
    bench.run()
    assert bench.read(0x30) == TXERR


def test_a_frame_in_loop_back_is_not_begun_again_by_the_next_request() -> None:
    bench = Bench().start(LOOPBACK)
    bench.load(0, 0x100, bytes(8))
    bench.load(2, 0x102, bytes(8), txp=3)
    bench.spi(0x81)
    bench.run(0.1)
    bench.spi(0x84)
    bench.run(0.04)  # 111 to 135 us after its start the first is through
    assert bench.read(0x2C) & 0x1C == 0x04
    bench.run(0.14)
    assert bench.read(0x2C) & 0x1C == 0x14


@pytest.mark.parametrize("way", [(0x02, 0x30, 0x03), (0x05, 0x30, 0x03, 0x03)])
def test_errata_concern_the_request_itself_and_no_other_write_to_its_register(way: tuple[int, ...]) -> None:
    bench = Bench(errata=True).start()
    bench.load(0, 0x123, bytes(8))
    bench.spi(0x81)
    bench.run(0.03)  # it is on the bus
    spi = bench.chip.spi
    spi.select()
    for byte in way:
        spi.exchange(byte)
    bench.run(3)
    spi.deselect()
    assert len(bench.heard) == 1


def test_after_a_reset_in_the_middle_of_its_frame_the_chip_sends_again() -> None:
    bench = Bench().start()
    bench.load(0, 0x123, bytes(8))
    bench.spi(0x81)
    bench.run(0.03)
    bench.spi(0xC0)
    assert bench.read(0x30) == 0
    bench.run()
    bench.start()
    bench.load(1, 0x124)
    bench.spi(0x82)
    bench.run()
    assert [frame.identifier for frame in bench.heard] == [0x124]
