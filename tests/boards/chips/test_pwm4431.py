"""Power control PWM of the PIC18F4431 by its registers (DS39616D section 18), on arithmetic by hand."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.pic18f4431 import Pwm4431

PTIF = 0x10
ENABLED = ((), (1,), (0, 1), (0, 1, 2, 3), (0, 1, 2, 3, 4, 5), (0, 1, 2, 3, 4, 5, 6, 7), (1, 3), (1, 3, 5, 7))
"""PWMEN of DS39616D, register 18-3: PWM1; PWM0 and 1; 0 to 3; 0 to 5; all; 1 and 3; all odd."""
MASKS = {
    "PTCON0": {"PTOPS": 0xF0, "PTCKPS": 0x0C, "PTMOD": 0x03}, "PTCON1": {"PTEN": 0x80},
    "PWMCON0": {"PWMEN": 0x70, "PMOD": 0x0F}, "PWMCON1": {"SEVOPS": 0xF0, "UDIS": 0x02},
    "DTCON": {"DTPS": 0xC0, "DT": 0x3F}, "OVDCOND": {}, "OVDCONS": {}, "PTPER": {}, "SEVTCMP": {},
    "PDC0": {}, "PDC1": {}, "PDC2": {}, "PDC3": {},
}  # fmt: skip
AT_RESET = {"PTPER": 0xFFF, "OVDCOND": 0xFF, "PWMCON0": 0x50}
"""What is not 0 after a reset."""


def test_registers_are_where_the_data_sheet_has_them() -> None:
    pwm = Pwm4431()
    assert (pwm.pir3, pwm.outputs, pwm.duty(0), pwm.period) == (0, [False] * 8, 0.0, 4 * 4096)
    for register, fields in MASKS.items():
        assert pwm[register] == AT_RESET.get(register, 0)
        for name, mask in fields.items():
            pwm[register] = 0
            pwm.put(name, mask // (mask & -mask))
            assert pwm[register] == mask
            with pytest.raises(ValueError, match="does not fit"):
                pwm.put(name, mask // (mask & -mask) + 1)
        pwm[register] = 0xFFFF
        bits = 14 if register[:3] == "PDC" else 12 if register in ("PTPER", "SEVTCMP") else 8
        assert pwm[register] == (1 << bits) - 1


def running(period: int = 99, **registers: int) -> Pwm4431:
    """All outputs on, (period + 1) cycles of four Q clocks."""
    pwm = Pwm4431()
    pwm["PTPER"] = period
    for name, value in registers.items():
        pwm[name] = value
    pwm.put("PTEN", 1)
    return pwm


def highs(pwm: Pwm4431, channel: int, periods: int = 3) -> list[int]:
    """Q clocks in which an output is on, period by period."""
    found = []
    for _ in range(periods):
        level, since, total, start = pwm.outputs[channel], 0, 0, None
        length = pwm.period
        edges = pwm.run()
        start = pwm._start - length
        for at, which, on in edges:
            if which == channel:
                total += (at - start - since) if level else 0
                level, since = on, at - start
        found.append(total + (length - since if level else 0))
    return found


@given(st.integers(0, 0x3FFF), st.integers(0, 0xFFF))
def test_a_duty_is_fourteen_bits_of_q_clocks_and_the_other_output_is_the_rest(duty: int, period: int) -> None:
    pwm = running(period, PDC1=duty)
    length = 4 * (period + 1)
    assert pwm.period == length
    wanted = min(duty, length)
    assert highs(pwm, 3) == [wanted] * 3
    assert highs(pwm, 2) == [length - wanted] * 3
    assert pwm.duty(1) == wanted / length


def test_20_khz_at_40_mhz_has_eleven_bits() -> None:
    """Fosc 40 MHz, PTPER = 40 MHz / 4 / 20 kHz - 1 = 499: 2000 steps of duty."""
    pwm = running(499)
    assert 40e6 / pwm.period == 20_000


@pytest.mark.parametrize(("code", "scale"), [(1, 4), (2, 16), (3, 64)])
def test_with_a_prescaler_the_two_lowest_bits_do_nothing(code: int, scale: int) -> None:
    pwm = running(99, PTCON0=code << 2, PDC0=0b111, SEVTCMP=25)
    heard: list[int] = []
    pwm.special_event = heard.append
    assert pwm.period == 4 * 100 * scale
    assert highs(pwm, 1, 1) == [0b100 * scale]
    assert heard == [4 * 25 * scale]


def test_what_is_written_counts_from_the_next_period_on_and_udis_holds_it_back() -> None:
    pwm = running(99, PDC0=40)
    pwm["PDC0"] = 80
    assert highs(pwm, 1, 2) == [40, 80]
    pwm.put("UDIS", 1)
    pwm["PDC0"] = 120
    assert highs(pwm, 1, 2) == [80, 80]
    pwm.put("UDIS", 0)
    assert highs(pwm, 1, 2) == [80, 120]


@given(st.integers(0, 400), st.integers(0, 63), st.integers(0, 3))
def test_complementary_outputs_are_never_on_together_and_dead_time_lies_between(
    duty: int, dead: int, scale: int
) -> None:
    pwm = running(99, PDC0=duty, DTCON=scale << 6 | dead)
    clocks = dead * (2, 4, 8, 16)[scale]
    edges = [edge for _ in range(3) for edge in pwm.run() if edge.channel < 2]
    levels = [False, False]
    off_at = [-clocks, -clocks]
    for at, channel, on in edges:
        levels[channel] = on
        assert not all(levels)
        if on:
            assert at - off_at[1 - channel] >= clocks or at == 0
        else:
            off_at[channel] = at


@pytest.mark.parametrize(("code", "scale"), [(0, 2), (1, 4), (2, 8), (3, 16)])
def test_the_dead_time_counts_clocks_of_its_prescaler(code: int, scale: int) -> None:
    first, *_ = (each for each in running(999, PDC0=2000, DTCON=code << 6 | 63).run() if each.channel == 1)
    assert (first.q_clocks, first.on) == (63 * scale, True)


def test_at_full_duty_nothing_changes_any_more() -> None:
    pwm = running(99, PDC0=400, DTCON=0x3F)
    assert [each for each in pwm.run() if each.channel < 2] == [(0, 1, True)]
    assert [each for each in pwm.run() if each.channel < 2] == []


@pytest.mark.parametrize("pair", range(4))
def test_each_pair_is_independent_by_its_own_bit(pair: int) -> None:
    pwm = running(99, PDC0=100, PDC1=100, PDC2=100, PDC3=100, PWMCON0=0x50 | 1 << pair)
    rises = {each.channel: each.q_clocks for each in pwm.run() if each.on}
    assert rises == {channel: 100 * (channel % 2 == 0 and channel // 2 != pair) for channel in range(8)}


def test_each_output_is_overridden_by_its_own_bit() -> None:
    pwm = running(OVDCOND=0, OVDCONS=0b10100110)
    pwm.run()
    assert pwm.outputs == [False, True, True, False, False, True, False, True]


def test_independent_outputs_follow_the_same_duty_without_dead_time() -> None:
    pwm = running(99, PDC0=100, PWMCON0=0x5F, DTCON=0x3F)
    assert highs(pwm, 0, 1) == [100]
    pwm = running(99, PDC0=100, PWMCON0=0x5F, DTCON=0x3F)
    assert highs(pwm, 1, 1) == [100]


def test_an_overridden_output_is_what_ovdcons_says() -> None:
    pwm = running(99, PDC0=100, OVDCOND=0b11111100, OVDCONS=0b01)
    assert highs(pwm, 0, 1) == [400]
    assert highs(pwm, 1, 1) == [0]


@pytest.mark.parametrize("enabled", range(8))
def test_channels_that_are_not_enabled_stay_low(enabled: int) -> None:
    pwm = running(99, PDC0=200, PDC1=200, PDC2=200, PDC3=200, PWMCON0=enabled << 4)
    on = {edge.channel for _ in range(2) for edge in pwm.run() if edge.on}
    assert on == set(ENABLED[enabled])


def test_a_special_event_beyond_the_period_never_comes() -> None:
    heard: list[int] = []
    for compare in (99, 100):
        pwm = running(99, SEVTCMP=compare)
        pwm.special_event = heard.append
        pwm.run()
    assert heard == [4 * 99]


def test_special_event_and_time_base_interrupt_by_their_postscalers() -> None:
    pwm = running(99, SEVTCMP=25, PWMCON1=0x10, PTCON0=0x20)
    heard: list[int] = []
    pwm.special_event = heard.append
    flags = []
    for _ in range(6):
        pwm.run()
        flags.append(pwm.pir3)
        pwm.pir3 = 0
    assert heard == [400 + 100, 1200 + 100, 2000 + 100]  # every second period, 25 cycles of four clocks in
    assert flags == [0, 0, PTIF, 0, 0, PTIF]


def test_what_is_not_built_and_what_does_not_fit_is_said() -> None:
    pwm = running(PTCON0=2)
    with pytest.raises(ValueError, match="free running"):
        pwm.run()
    with pytest.raises(ValueError, match="does not fit"):
        pwm.put("DT", 64)
    pwm["PTPER"] = 0x1FFF
    assert pwm["PTPER"] == 0xFFF
    with pytest.raises(KeyError):
        pwm["PDC4"] = 1
    assert Pwm4431().run() == []
