"""QEI, PWM and ADC at register level, and that the boards' fast ones agree (hardware.md 3.4, 3.5)."""

from collections.abc import Callable

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.dspic30f import Adc, MotorControlPwm, QeiModule
from boards.chips.dspic30f.pwm import Edge
from boards.chips.dspic30f.registers import Qeim, Ssrc
from boards.chips.pic18f4431 import Qei4431
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
    other.qeicon |= 6 << 2
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
    for count, counted in ((1, 1), (2, 1), (3, 2), (4, 2)):  # A changes, B does, A, B
        walk(qei, count, count)
        assert qei.registers["POSCNT"] == counted
    walk(qei, 4, 40)
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


def test_each_input_has_its_filter() -> None:
    qei = dspic(Qeim.X4_INDEX, maxcnt=99)
    qei.registers["DFLTCON"] = 0x80
    for count in (1, 2, 3):
        for _ in range(3):
            assert qei.registers["POSCNT"] == count - 1
            qei.sample(*levels(count))
    for _ in range(2):
        qei.sample(0, 0, 1)
        assert (qei.registers["POSCNT"], qei.registers.field("INDX")) == (3, 0)
    qei.sample(0, 0, 1)
    assert (qei.registers["POSCNT"], qei.registers.field("INDX"), qei.interrupt) == (0, 1, True)


def test_an_index_at_the_first_sample_counts() -> None:
    for qei in (dspic(Qeim.X4_INDEX), Qei4431()):
        if isinstance(qei, QeiModule):
            qei.registers["POSCNT"] = 5
            qei.registers.put("UPDN", 1)
        else:
            qei.qeicon, qei.poscnt = qei.qeicon | X4_INDEX, 5
        qei.sample(0, 0, 1)
        assert (qei.registers["POSCNT"] if isinstance(qei, QeiModule) else qei.poscnt) == 0


def test_an_index_counts_once_and_in_index_mode_only() -> None:
    for mode, reset in ((Qeim.X4_INDEX, True), (Qeim.X2_INDEX, True), (Qeim.X4_MATCH, False)):
        qei = dspic(mode, maxcnt=99)
        walk(qei, 0, 4)
        qei.sample(0, 0, 1)
        assert (qei.registers["POSCNT"] == 0, qei.interrupt) == (reset, reset)
        qei.interrupt = False
        qei.sample(0, 0, 1)
        assert not qei.interrupt


def test_a_register_of_16_bits_wraps_without_a_match() -> None:
    up, down = dspic(Qeim.X4_INDEX), dspic(Qeim.X4_INDEX)
    up.registers["POSCNT"] = 0xFFFF
    walk(up, 0, 1)
    walk(down, 0, -1)
    assert (up.registers["POSCNT"], down.registers["POSCNT"]) == (0, 0xFFFF)
    assert up.registers.field("CNTERR") == down.registers.field("CNTERR") == 1


@pytest.mark.parametrize(
    ("code", "x4", "x2"),
    [(0, 0, 0), (1, 0, 0), (2, 0, 0), (3, 0, 0), (4, 0, 1), (5, 0, 1), (6, 1, 0), (7, 1, 0)],
)
def test_modes_by_their_codes(code: int, x4: int, x2: int) -> None:
    """FRM, register 16-1: by index and by match, on both edges of A and on all four."""
    qei = QeiModule()
    qei.registers["QEICON"] = code << 8
    walk(qei, 0, 20)
    assert qei.registers["POSCNT"] == 20 * x4 + 10 * x2
    walk(qei, 20, 24)
    qei.sample(*levels(24), 1)
    assert qei.interrupt == (code in (4, 6))


def test_swapped_channels_and_off() -> None:
    qei = dspic(Qeim.X4_MATCH)
    qei.registers.put("SWPAB", 1)
    walk(qei, 0, 5)
    assert qei.registers["POSCNT"] == 0x10000 - 5
    with pytest.raises(ValueError, match="QEIM has 3 bits"):
        qei.registers.put("QEIM", 8)


X4_MATCH, X4_INDEX, QERR, UP = 6 << 2, 5 << 2, 0x40, 0x20
"""Bits of QEICON in DS39616D."""
MATCHED, TURNED = 0x04, 0x08
"""Bits of PIR3 there."""


@pytest.mark.parametrize(
    ("code", "counted", "by_index"),
    [(0, 0, 0), (1, 10, 1), (2, 10, 0), (3, 0, 0), (4, 0, 0), (5, 20, 1), (6, 20, 0)],
)
def test_pic18f4431_modes_by_their_codes(code: int, counted: int, by_index: int) -> None:
    qei = Qei4431()
    assert (qei.qeicon, qei.poscnt, qei.maxcnt, qei.pir3) == (UP, 0, 0xFFFF, 0)
    qei.qeicon |= code << 2
    walk(qei, 0, 20)
    assert (qei.poscnt, qei.mode) == (counted, code)
    qei.sample(*levels(20), 1)
    assert (qei.poscnt, qei.pir3) == (0 if by_index else counted, MATCHED * by_index)


def test_pic18f4431_matches_turns_and_loses() -> None:
    qei = Qei4431()
    qei.qeicon |= X4_MATCH
    qei.maxcnt = 9
    walk(qei, 0, 9)
    assert (qei.poscnt, qei.pir3) == (9, 0)
    walk(qei, 9, 10)
    assert (qei.poscnt, qei.pir3) == (0, MATCHED)
    qei.pir3 = 0
    walk(qei, 10, 9)
    assert (qei.poscnt, qei.pir3) == (9, MATCHED | TURNED)
    qei.pir3 = 0
    walk(qei, 9, 8)
    assert (qei.poscnt, qei.pir3, qei.qeicon) == (8, 0, X4_MATCH)  # down still, which is no news
    qei.sample(*levels(10))
    assert (qei.qeicon, qei.poscnt) == (X4_MATCH | QERR, 8)


def test_pic18f4431_index_resets_forward_at_its_rise_and_reverse_at_its_fall() -> None:
    qei = Qei4431()
    qei.qeicon |= X4_INDEX
    qei.maxcnt = 99
    walk(qei, 0, 7)
    qei.sample(*levels(7), 1)
    assert (qei.poscnt, qei.pir3) == (0, MATCHED)
    qei.pir3 = 0
    for index in (1, 0):  # it is one still, and falls
        qei.sample(*levels(8), index)
        assert (qei.poscnt, qei.pir3) == (1, 0)
    walk(qei, 8, 5)
    assert (qei.poscnt, qei.pir3) == (0x10000 - 2, TURNED)
    qei.pir3 = 0
    qei.sample(*levels(5), 1)
    assert (qei.poscnt, qei.pir3) == (0x10000 - 2, 0)
    qei.sample(*levels(5), 0)
    assert (qei.poscnt, qei.pir3) == (99, MATCHED)


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
    chip = pwm(0x3FF, 1, 2047, 0xFFFF)
    assert chip.period == 2048
    assert 2 * 30e6 / chip.period == pytest.approx(29_297, abs=1)
    assert [chip.duty(pair) for pair in range(3)] == [1 / 2048, 2047 / 2048, 1.0]
    assert pwm(0xFFFF).period == 2 * 0x8000


@pytest.mark.parametrize(("code", "scale"), [(0, 1), (1, 4), (2, 16), (3, 64)])
def test_a_prescaler_stretches_period_duty_and_special_event(code: int, scale: int) -> None:
    chip = MotorControlPwm()
    for name, value in {"PTPER": 99, "PDC1": 50, "SEVTCMP": 0x8000 | 30, "PTCON": code << 2}.items():
        chip.registers[name] = value  # bit 15 of SEVTCMP is a direction, which counting up has not
    heard: list[int] = []
    chip.special_event = heard.append
    chip.start(1000)
    assert (chip.period, chip.duty(0)) == (200 * scale, 0.25)
    assert on_time(chip.run(), 0, True, 0) == 50 * scale
    assert heard == [1000 + 60 * scale]


@pytest.mark.parametrize(("code", "scale"), [(0, 1), (1, 2), (2, 4), (3, 8)])
def test_dead_time_has_a_prescaler(code: int, scale: int) -> None:
    first, *_ = (edge for edge in pwm(999, 1200, dead=code << 6 | 63).run() if edge.pair == 0)
    assert first == Edge(2 * 63 * scale, 0, True, True)  # two half cycles to a cycle


def test_after_the_first_period_full_duty_has_no_dead_time_either() -> None:
    chip = pwm(99, 200, dead=5)
    chip.run()
    assert [edge for edge in chip.run() if edge.pair == 0] == [Edge(200, 0, True, True)]


def test_firmware_starts_the_time_base_by_its_bit() -> None:
    chip = MotorControlPwm()
    chip.registers["PTCON"] = 0x8000
    assert [edge.half_cycles for edge in chip.run()] == [0, 0, 0]  # no duty: the low sides
    assert chip.duty(0) == 0.0


MASKS = {
    "QEICON": {"CNTERR": 0x8000, "INDX": 0x1000, "UPDN": 0x0800, "QEIM": 0x0700, "SWPAB": 0x0080},
    "DFLTCON": {"QEOUT": 0x0080},
    "PTCON": {"PTEN": 0x8000, "PTCKPS": 0x000C, "PTMOD": 0x0003},
    "PWMCON2": {"SEVOPS": 0x0F00},
    "DTCON1": {"DTAPS": 0x00C0, "DTA": 0x003F},
    "ADCON1": {"ADON": 0x8000, "SSRC": 0x00E0, "ASAM": 0x0004, "SAMP": 0x0002, "DONE": 0x0001},
    "ADCON2": {"CHPS": 0x0300, "SMPI": 0x003C},
    "ADCON3": {"ADCS": 0x003F},
}
"""Register maps of the FRM, sections 15 to 17."""
AT_RESET = {"PTPER": 0x7FFF, "MAXCNT": 0xFFFF}
"""What is not 0 there."""


@pytest.mark.parametrize("chip", [QeiModule, MotorControlPwm, lambda: Adc(lambda _t, _c: 0.0, 1.0)])
def test_registers_are_where_the_manual_has_them(
    chip: Callable[[], QeiModule | MotorControlPwm | Adc],
) -> None:
    registers = chip().registers
    for register in registers._values:
        assert registers[register] == AT_RESET.get(register, 0)
        for name, mask in MASKS.get(register, {}).items():
            registers[register] = 0
            registers.put(name, mask // (mask & -mask))
            assert registers[register] == mask
            with pytest.raises(ValueError, match="does not fit"):
                registers.put(name, mask // (mask & -mask) + 1)
            registers[register] = 0x1_FFFF ^ mask
            assert registers.field(name) == 0


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


@pytest.mark.parametrize("code", [0, 1, 2, 3, 7])
def test_a_trigger_is_heard_by_its_code_alone(code: int) -> None:
    """FRM, register 17-1: SAMP, INT0, timer 3, PWM, the converter itself."""
    adc = Adc(lambda _t, _c: 2.5, tcy_ns=100)
    assert (adc.buffers, adc.interrupt, adc.ready_ns) == ([0] * 16, False, 0)
    adc.registers["ADCON1"] = 0x8002 | code << 5
    sources = (Ssrc.MANUAL, Ssrc.INT0, Ssrc.TIMER3, Ssrc.PWM, None, None, None, Ssrc.AUTO)
    for source in (each for each in sources if each is not None and each is not sources[code]):
        assert not adc.trigger(0, source)
    wanted = sources[code]
    assert wanted is not None and adc.trigger(0, wanted)


@pytest.mark.parametrize(("code", "channels"), [(0, 1), (1, 2), (2, 4), (3, 4)])
def test_channels_fill_the_buffers_one_after_the_other(code: int, channels: int) -> None:
    adc = Adc(lambda t_ns, channel: (t_ns / 1e6 + channel) * 5 / 1024, tcy_ns=100)
    adc.registers["ADCON1"] = 0x8004  # samples again by itself
    adc.registers["ADCON2"] = code << 8 | 2 << 2  # interrupt after three
    for place in range(5):
        assert adc.clear_samp(place * 100_000_000) and adc.registers.field("SAMP") == 1
        assert adc.interrupt == (place == 2)
        first = place % 3 * channels
        assert adc.buffers[first : first + channels] == [place * 100 + k for k in range(channels)]
        adc.interrupt = False


def test_sixteen_samples_fill_the_buffers() -> None:
    adc = Adc(lambda t_ns, _c: t_ns * 5 / 1024, tcy_ns=0.01)
    adc.registers["ADCON1"], adc.registers["ADCON2"] = 0x8004, 15 << 2
    assert all(adc.clear_samp(place) for place in range(17))
    assert adc.buffers == [16, *range(1, 16)]
