"""Modes, wake-up, counters, thresholds, interrupts (DS20001801 sections 6, 7, 10)."""

import itertools

import pytest

from boards.chips.mcp2515.registers import error_flags
from bus.can import Flip, Frame
from tests.boards.chips.mcp2515.bench import CONFIG, LISTEN, LOOPBACK, NORMAL, SLEEP, Bench

RX0, ERR, WAK, MERR = 0x01, 0x20, 0x40, 0x80


def test_listen_only_hears_and_drives_nothing() -> None:
    bench = Bench().start(LISTEN)
    assert bench.partner.send(Frame(0x123, b""), 0)
    bench.run()
    assert bench.read(0x2C) & RX0 == 0  # nobody acknowledged
    assert set(bench.wire.errors) == {"ack"}
    assert bench.read(0x1D) == 0
    bench.wire.attach("third")
    bench.run(3)
    assert bench.read(0x2C) & RX0
    assert bench.partner.tec < 128
    before = sum(bench.wire.errors.values())
    bench.write(0x2C, 0)
    bench.wire.disturb(lambda _t, _f, _s: Flip(30, seen_by="chip"))
    bench.partner_sends(Frame(0x124, b""))
    assert bench.read(0x2C) == MERR  # it missed the frame, the others did not
    assert sum(bench.wire.errors.values()) == before + 1
    assert bench.read(0x1D) == 0


@pytest.mark.parametrize("mode", [CONFIG, SLEEP, LOOPBACK])
def test_in_modes_off_the_bus_nothing_is_heard_or_acknowledged(mode: int) -> None:
    bench = Bench().start(mode)
    bench.partner.send(Frame(0x123, b""), 0)
    bench.run()
    assert bench.wire.frames == 0
    assert bench.read(0x2C) == 0
    assert bench.read(0x0E) & 0xE0 == mode


def test_bus_activity_wakes_into_listen_only_and_that_frame_is_missed() -> None:
    for allowed in (True, False):
        bench = Bench().start()
        bench.wire.attach("third")
        bench.write(0x2B, WAK if allowed else 0)
        bench.mode(SLEEP)
        assert bench.read(0x0E) & 0xE0 == SLEEP
        bench.partner_sends(Frame(0x123, b"\x01"))
        assert bench.read(0x0E) == ((LISTEN | 2 << 1) if allowed else SLEEP)
        assert bench.read(0x2C) == (WAK if allowed else 0)
        assert bench.pin == ([True] if allowed else [])
        bench.partner_sends(Frame(0x124, b"\x02"))
        assert bench.read(0x2C) == (WAK | RX0 if allowed else 0)
        if allowed:
            assert bench.read(0x66) == 2
            bench.mode(NORMAL)
            assert bench.read(0x0E) & 0xE0 == NORMAL


def test_the_microcontroller_wakes_the_chip_by_setting_wakif() -> None:
    bench = Bench().start()
    bench.mode(SLEEP)
    bench.mode(NORMAL)
    assert bench.read(0x0E) & 0xE0 == SLEEP  # without its oscillator it changes no mode
    bench.spi(0x05, 0x2C, WAK, WAK)
    assert bench.read(0x0E) & 0xE0 == SLEEP
    bench.write(0x2C, 0)
    bench.spi(0x05, 0x2B, WAK, WAK)
    bench.spi(0x05, 0x2C, WAK, WAK)
    assert bench.read(0x0E) & 0xE0 == LISTEN


def test_unknown_modes_are_not_entered() -> None:
    bench = Bench().start()
    for wanted in (0xA0, 0xC0, 0xE0):
        bench.mode(wanted)
        assert bench.read(0x0E) & 0xE0 == NORMAL
        assert bench.read(0x0F) & 0xE0 == wanted


@pytest.mark.parametrize(
    ("tec", "rec", "flags"),
    [
        (0, 0, 0), (95, 95, 0), (96, 0, 0x05), (0, 96, 0x03), (127, 127, 0x07), (128, 0, 0x15),
        (0, 128, 0x0B),
        (128, 128, 0x1F), (255, 0, 0x15),
    ],
)  # fmt: skip
def test_error_flags_at_their_thresholds(tec: int, rec: int, flags: int) -> None:
    assert error_flags(tec, rec, bus_off=False) == flags
    assert error_flags(tec, rec, bus_off=True) == flags | 0x20


def test_a_lone_node_goes_passive_and_never_off() -> None:
    bench = Bench().start()
    bench.write(0x2B, ERR)
    bench.partner.online = False
    bench.load(0, 0x123)
    bench.spi(0x81)
    told = []
    for _ in range(200):
        bench.run(0.05)
        told.append((bench.read(0x1C), bench.read(0x2D), bench.read(0x2C) & ERR))
        if told[-1][2]:
            bench.spi(0x05, 0x2C, ERR, 0)
    rises = [now for before, now in itertools.pairwise(told) if now[1] != before[1]]
    assert [(tec, flags) for tec, flags, _ in rises] == [(96, 0x05), (128, 0x15)]
    assert [error for _, _, error in told].count(ERR) == 2
    assert told[-1][:2] == (128, 0x15)
    assert bench.pin == [True, False, True, False]
    assert bench.read(0x30) == 0x18


def test_bus_off_and_back_after_128_times_11_recessive_bits() -> None:
    bench = Bench().start()
    bench.write(0x2B, ERR)
    bench.wire.disturb(lambda _t, _f, sender: Flip(35) if sender == "chip" else None)
    bench.load(0, 0x123, bytes(8))
    bench.spi(0x81)
    while not bench.read(0x2D) & 0x20:
        bench.run(0.01)
        assert bench.queue.now_ns < 10_000_000
    off_ns = bench.queue.now_ns
    assert bench.read(0x2D) == 0x35
    assert bench.read(0x1C) == 255
    assert bench.read(0x2C) & ERR
    bench.wire.disturb(None)
    while bench.read(0x2D) & 0x20:
        bench.run(0.01)
    assert 1_408_000 - 20_000 < bench.queue.now_ns - off_ns < 1_408_000 + 30_000
    assert bench.read(0x2D) == 0
    bench.run()
    assert len(bench.heard) == 1  # the request was kept
    assert (bench.read(0x1C), bench.read(0x1D)) == (0, 0)


def test_receive_errors_count_and_flag() -> None:
    bench = Bench().start()
    flips = [Flip(35)] * 5 + [None]
    bench.wire.disturb(lambda _t, _f, _s: flips.pop(0))
    bench.partner.send(Frame(0x123, bytes(8)), 0)
    while len(flips) > 1:
        bench.run(0.02)
    bench.run(0.05)
    assert bench.read(0x1D) == 5
    assert bench.read(0x2C) == MERR
    assert bench.read(0x1C) == 0
    bench.run()
    assert bench.read(0x1D) == 4
    assert bench.read(0x2C) == MERR | RX0


def test_counters_start_again_after_configuration_and_in_listen_only_mode() -> None:
    for mode in (CONFIG, LISTEN):
        bench = Bench().start()
        bench.chip.port.rec, bench.chip.port.tec = 5, 6
        bench.mode(mode)
        assert (bench.read(0x1C), bench.read(0x1D)) == (0, 0)


def test_interrupt_codes_in_their_order_and_only_of_enabled_sources() -> None:
    order = [(0x20, 1), (0x40, 2), (0x04, 3), (0x08, 4), (0x10, 5), (0x01, 6), (0x02, 7)]
    bench = Bench().start()
    bench.write(0x2B, 0xFF)
    bench.write(0x2C, 0xFF)
    for flag, code in order:
        assert bench.read(0x0E) == code << 1
        bench.spi(0x05, 0x2C, flag, 0)
    assert bench.read(0x0E) == 0  # MERRF alone has no code
    assert bench.chip.interrupt_pin
    bench.write(0x2C, 0x28)
    bench.write(0x2B, 0x08)
    assert bench.read(0x0E) == 4 << 1
    bench.write(0x2B, 0x00)
    assert bench.read(0x0E) == 0
    assert not bench.chip.interrupt_pin


def test_the_pin_follows_flags_and_enables() -> None:
    bench = Bench().start()
    bench.write(0x2C, 0x81)
    assert bench.pin == []
    bench.write(0x2B, 0x01)
    bench.write(0x2B, 0x81)
    assert bench.pin == [True]
    bench.write(0x2C, 0x02)
    assert bench.pin == [True, False]
    bench.write(0x2C, 0x01)
    bench.spi(0xC0)
    assert bench.pin == [True, False, True, False]
    assert not bench.chip.interrupt_pin
