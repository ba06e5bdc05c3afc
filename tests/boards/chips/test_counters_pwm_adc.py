"""QEI, PWM and ADC at register level, and that the boards' fast ones agree (hardware.md 3.4, 3.5)."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.dspic30f import Adc, MotorControlPwm, QeiModule
from boards.chips.dspic30f.pwm import Edge
from boards.chips.dspic30f.registers import Qeim, Ssrc
from boards.chips.pic18f4431 import Qei4431
from boards.chips.pic18f4431.qei import IC2QEIF, IC3DRIF, QERR, Mode
from boards.chips.quadrature import levels
from boards.silicon.pwm import MotorPwm
from boards.silicon.qei import Qei


def dspic(mode: Qeim, maxcnt: int = 0xFFFF) -> QeiModule:
    qei = QeiModule()
    qei.registers["QEICON"] = mode << 8
    qei.registers["MAXCNT"] = maxcnt
    return qei


def walk(qei: QeiModule | Qei4431, start: int, end: int) -> None:
    step = 1 if end >= start else -1
    for count in range(start, end + step, step):
        qei.sample(*levels(count))


walks = st.lists(st.integers(-300, 300), min_size=1, max_size=6)


@given(walks)
def test_the_fast_counter_is_the_register_in_free_running_mode(stops: list[int]) -> None:
    qei, other, at = dspic(Qeim.X4_MATCH), Qei4431(), 0
    other.qeicon |= Mode.X4_MATCH << 2
    for stop in stops:
        walk(qei, at, stop)
        walk(other, at, stop)
        at = stop
        expected = Qei(lambda _t, at=at: at).poscnt(0)  # type: ignore[misc]
        assert qei.registers["POSCNT"] == other.poscnt == expected
        assert qei.registers.field("CNTERR") == 0


def test_maxcnt_match_wraps_both_ways_and_interrupts() -> None:
    qei = dspic(Qeim.X4_MATCH, maxcnt=9)
    walk(qei, 0, 9)
    assert (qei.registers["POSCNT"], qei.interrupt) == (9, False)
    walk(qei, 9, 10)
    assert (qei.registers["POSCNT"], qei.interrupt, qei.registers.field("UPDN")) == (0, True, 1)
    qei.interrupt = False
    walk(qei, 10, 9)
    assert (qei.registers["POSCNT"], qei.interrupt, qei.registers.field("UPDN")) == (9, True, 0)


@pytest.mark.parametrize("mode", [Qeim.X2_MATCH, Qeim.X2_INDEX])
def test_x2_counts_the_edges_of_a_only(mode: Qeim) -> None:
    qei = dspic(mode)
    walk(qei, 0, 40)
    assert qei.registers["POSCNT"] == 20
    walk(qei, 40, 20)
    assert qei.registers["POSCNT"] == 10


def test_the_index_resets_where_a_and_b_are_low() -> None:
    qei = dspic(Qeim.X4_INDEX, maxcnt=99)
    walk(qei, 0, 40)
    qei.sample(*levels(41), 1)
    assert qei.registers["POSCNT"] == 41  # A is high: not yet
    assert qei.registers.field("INDX") == 1
    for count in (42, 43):
        qei.sample(*levels(count), 1)
    qei.sample(*levels(44), 1)
    assert (qei.registers["POSCNT"], qei.interrupt) == (0, True)
    walk(qei, 44, 48)
    walk(qei, 48, 45)
    qei.sample(*levels(44), 1)
    assert qei.registers["POSCNT"] == 99  # downwards it is set to MAXCNT


def test_a_missed_index_is_a_count_error_in_index_mode_only() -> None:
    for mode, error in ((Qeim.X4_INDEX, 1), (Qeim.X4_MATCH, 0)):
        qei = dspic(mode, maxcnt=9)
        walk(qei, 0, 9)
        assert qei.registers.field("CNTERR") == 0
        walk(qei, 9, 10)
        assert qei.registers.field("CNTERR") == error
        down = dspic(mode, maxcnt=9)
        walk(down, 0, -1)
        assert down.registers.field("CNTERR") == error


def test_the_filter_wants_three_equal_samples() -> None:
    qei = dspic(Qeim.X4_MATCH)
    qei.registers["DFLTCON"] = 0x80
    for a, count in ((1, 0), (1, 0), (0, 0), (1, 0), (1, 0), (1, 1)):
        qei.sample(a, 0)
        assert qei.registers["POSCNT"] == count


def test_swapped_channels_and_off() -> None:
    qei = dspic(Qeim.X4_MATCH)
    qei.registers.put("SWPAB", 1)
    walk(qei, 0, 5)
    assert qei.registers["POSCNT"] == 0x10000 - 5
    off = dspic(Qeim.OFF)
    walk(off, 0, 5)
    assert off.registers["POSCNT"] == 0
    with pytest.raises(ValueError, match="QEIM has 3 bits"):
        qei.registers.put("QEIM", 8)


def test_pic18f4431_matches_turns_loses_and_resets() -> None:
    qei = Qei4431()
    qei.qeicon |= Mode.X4_MATCH << 2
    qei.maxcnt = 9
    walk(qei, 0, 9)
    assert (qei.poscnt, qei.pir3) == (9, 0)
    walk(qei, 9, 10)
    assert (qei.poscnt, qei.pir3) == (0, IC2QEIF)
    qei.pir3 = 0
    walk(qei, 10, 9)
    assert (qei.poscnt, qei.pir3) == (9, IC2QEIF | IC3DRIF)
    assert not qei.qeicon & QERR
    qei.sample(*levels(11))
    assert qei.qeicon & QERR
    index = Qei4431()
    index.qeicon |= Mode.X4_INDEX << 2
    index.maxcnt = 99
    walk(index, 0, 7)
    index.sample(*levels(7), 1)
    assert index.poscnt == 0  # forward: rising edge
    index.sample(*levels(7), 0)
    walk(index, 7, 5)
    index.sample(*levels(5), 1)
    assert index.poscnt == 0x10000 - 2
    index.sample(*levels(5), 0)
    assert index.poscnt == 99  # reverse: falling edge
    x2 = Qei4431()
    x2.qeicon |= Mode.X2_MATCH << 2
    walk(x2, 0, 40)
    assert x2.poscnt == 20
    walk(Qei4431(), 0, 5)


# --- PWM ------------------------------------------------------------------------------------------------
def pwm(ptper: int, *pdc: int, dead: int = 0) -> MotorControlPwm:
    chip = MotorControlPwm()
    chip.registers["PTPER"] = ptper
    for pair, value in enumerate(pdc):
        chip.registers[f"PDC{pair + 1}"] = value
    chip.registers["DTCON1"] = dead
    chip.start(0)
    return chip


def on_time(edges: list[Edge], pair: int, high: bool, end: int) -> int:
    """Half cycles within one period during which a switch conducts."""
    total, since = 0, None
    for edge in edges:
        if (edge.pair, edge.high_side) == (pair, high):
            if edge.on:
                since = edge.half_cycles
            elif since is not None:
                total, since = total + edge.half_cycles - since, None
    return total + (end - since if since is not None else 0)


@given(st.integers(1, 0x7FFF), st.integers(0, 0xFFFF))
def test_the_fast_duty_is_the_share_of_the_edges(ptper: int, pdc: int) -> None:
    chip = pwm(ptper, pdc)
    driven: list[tuple[int, float, float]] = []
    fast = MotorPwm(lambda *what: driven.append(what), steps=2 * (ptper + 1))
    fast.write(0, pdc, 0)
    edges = chip.run()
    period = 2 * (ptper + 1)
    assert on_time(edges, 0, True, period) == min(pdc, period)
    assert on_time(edges, 0, False, period) == period - min(pdc, period)
    if pdc:
        assert on_time(edges, 0, True, period) / period == driven[0][1]


def test_resolution_is_half_a_cycle_and_ptper_has_15_bits() -> None:
    # FRM p. 15-20: 30 MIPS, PTPER 0x3FF: 11 bit at 29.3 kHz; PDC > 2 PTPER + 1 is 100 %
    chip = pwm(0x3FF, 1, 2047, 2048)
    assert chip.period == 2048
    assert 2 * 30e6 / chip.period == pytest.approx(29_297, abs=1)
    assert [chip.duty(pair) for pair in range(3)] == [1 / 2048, 2047 / 2048, 1.0]
    assert pwm(0xFFFF).period == 2 * 0x8000
    chip.registers.put("PTCKPS", 2)
    chip.run()
    assert chip.period == 16 * 2048


def test_period_and_duty_written_count_from_the_next_period_on() -> None:
    chip = pwm(99, 100)
    chip.registers["PTPER"] = 49
    chip.registers["PDC1"] = 10
    assert (chip.period, chip.duty(0)) == (200, 0.5)
    first = chip.run()
    assert on_time(first, 0, True, 200) == 100
    assert (chip.period, chip.duty(0)) == (100, 0.1)
    assert min(edge.half_cycles for edge in chip.run()) == 200


def test_dead_time_keeps_both_switches_off_between() -> None:
    chip = pwm(99, 80, dead=0b01_000101)  # 5 x 2 cycles: 20 half cycles
    edges = chip.run()
    assert [edge for edge in edges if edge.pair == 0] == [
        Edge(20, 0, True, True),
        Edge(80, 0, True, False),
        Edge(100, 0, False, True),
        Edge(200, 0, False, False),
    ]
    assert on_time(pwm(99, 10, dead=0b01_000101).run(), 0, True, 200) == 0  # shorter than the dead time
    assert on_time(pwm(99, 0, dead=5).run(), 0, False, 200) == 200


def test_special_event_triggers_the_adc_at_its_place_every_so_often() -> None:
    chip = pwm(99, 100)
    adc = Adc(lambda t_ns, channel: t_ns * 1e-4 + channel, tcy_ns=33.3)
    adc.registers["ADCON1"] = 0x8000 | Ssrc.PWM << 5 | 0x0C
    adc.registers["ADCON2"] = 1 << 8 | 1 << 2  # two channels, interrupt after two samples
    adc.registers["ADCON3"] = 3
    events: list[int] = []

    def fire(at: int) -> None:
        events.append(at)
        adc.trigger(at * 100, Ssrc.PWM)

    chip.special_event = fire
    chip.registers["SEVTCMP"] = 50
    chip.registers["PWMCON2"] = 1 << 8
    for _ in range(2):
        chip.run()
    assert events == [300]
    assert not adc.interrupt
    for _ in range(2):
        chip.run()
    assert events == [300, 700]
    assert adc.interrupt
    # 30000 ns is 3 V, 70000 ns 7 V
    assert adc.buffers[:4] == [int(3 * 204.8), int(4 * 204.8), 1023, 1023]
    assert adc.ready_ns == pytest.approx(70_000 + 2 * 12 * 33.3 * 2)
    chip.registers["SEVTCMP"] = 100
    chip.run()
    chip.run()
    assert len(events) == 2


def test_a_stopped_pwm_and_modes_not_built() -> None:
    assert MotorControlPwm().run() == []
    chip = pwm(9)
    chip.registers.put("PTMOD", 2)
    with pytest.raises(ValueError, match="free running"):
        chip.run()
    with pytest.raises(KeyError):
        chip.registers["PTMR2"] = 0


def test_adc_triggers() -> None:
    adc = Adc(lambda _t, _c: 2.5, tcy_ns=100)
    adc.registers["ADCON1"] = 0x8000
    assert not adc.clear_samp(0)  # nothing sampled
    adc.registers.put("SAMP", 1)
    assert not adc.trigger(0, Ssrc.TIMER3)
    assert adc.clear_samp(0)
    assert (adc.buffers[0], adc.interrupt, adc.registers.field("DONE")) == (512, True, 1)
    assert adc.registers.field("SAMP") == 0
    adc.registers.put("SAMP", 1)
    assert not adc.clear_samp(599)  # still converting: 12 TAD of 50 ns
    assert adc.clear_samp(600)
    adc.registers.put("ADON", 0)
    adc.registers.put("SAMP", 1)
    assert not adc.clear_samp(10_000)
