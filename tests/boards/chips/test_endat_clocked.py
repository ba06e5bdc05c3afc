"""EnDat clock by clock, against the tables of hardware.md 3.1 and against the fast path."""

import contextlib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from boards.chips.endat import ClockedEncoder, ClockedMaster, EndatError
from boards.chips.endat import registers as at
from boards.chips.endat.answer import Answers, crc_bits
from boards.chips.endat.encoder import Phase
from boards.chips.endat.registers import Alarm, Info
from boards.silicon.endat import EndatEncoder, EndatMaster, check

MS = 1_000_000
SLOW_HZ = 100_000
"""The slowest clock of hardware.md 3.1: the 12 ms of a memory access are fewest edges."""
positions = st.integers(0, (1 << 29) - 1)


class Line:
    """Both ends, alarms of power-up cleared; every transfer starts 100 us after the last."""

    def __init__(self, position: int = 0, delay_ns: int = 0, clock_hz: int = 1_000_000) -> None:
        self.value = position
        self.latches: list[int] = []
        self.encoder = ClockedEncoder(self._pin)
        self.master = ClockedMaster(self.encoder, clock_hz, delay_ns)
        self.encoder.answers.memory.clear_errors()

    def _pin(self, t_ns: int) -> int:
        self.latches.append(t_ns)
        return self.value

    @property
    def next_ns(self) -> int:
        return self.master.t_ns + 100_000


@given(positions, st.booleans())
def test_the_fast_path_gives_the_same_frames_at_the_same_times(position: int, alarm: bool) -> None:
    fast = EndatEncoder(lambda _t: position)
    fast.alarm = alarm
    line = Line(position)
    if alarm:
        line.encoder.answers.memory.raise_alarm(Alarm.LIGHT)
    bits = line.master.exchange(1000, at.SEND_POSITION_INFO, None, 36)
    frame = fast.transfer(0)
    crc = frame >> 31
    assert bits == [frame >> k & 1 for k in range(31)] + [crc >> k & 1 for k in range(4, -1, -1)]
    assert line.latches == [1000]
    # 52 falling edges 1 us apart; the fast path counts 52 whole clocks
    assert line.master.t_ns - 1000 == EndatMaster(fast).latch_to_data_ns - 1000
    value, told, *_ = line.master.position(line.next_ns)
    assert check(frame) == (value, told, True)


@pytest.mark.parametrize(
    ("position", "old", "healthy", "alarm"),
    [  # derived vectors of hardware.md 3.1: 2.1 frame, 2.2 healthy, 2.2 with alarm
        (0, 0, 26, 1), (1, 8, 18, 9), (1 << 28, 11, 17, 10), ((1 << 29) - 1, 16, 10, 17),
        (0x12345678, 4, 30, 5), (123456789, 9, 19, 8),
    ],
)  # fmt: skip
def test_crcs_on_the_line(position: int, old: int, healthy: int, alarm: int) -> None:
    def crc(code: int, count: int) -> int:
        return int("".join(map(str, line.master.exchange(line.next_ns, code, None, count)[-5:])), 2)

    line = Line(position)
    assert crc(at.SEND_POSITION, 35) == old
    assert crc(at.SEND_POSITION_INFO, 36) == healthy
    line.encoder.answers.memory.raise_alarm(Alarm.AMPLITUDE)
    assert crc(at.SEND_POSITION_INFO, 36) == alarm


@pytest.mark.parametrize(
    ("head", "data", "crc"),
    [(0, 0, 24), (0xFF, 0xFFFF, 18), (0x45, 0x1234, 3), (0xA1, 13, 30), (0x47, 0xA1, 31)],
)
def test_crcs_of_parameters(head: int, data: int, crc: int) -> None:
    bits = [int(bit) for bit in f"{head:08b}{data:016b}"]
    assert int("".join(map(str, crc_bits(bits))), 2) == crc


ARGUMENTS = {0b001110, 0b011100, 0b100011, 0b101010, 0b110001, 0b010010}
SUPPLEMENTS = {0b001001, 0b011011, 0b100100, 0b101101, 0b110110}
PLAIN = {0b000111, 0b111000, 0b010101}
MODES = {code: (code in ARGUMENTS, code in SUPPLEMENTS) for code in ARGUMENTS | SUPPLEMENTS | PLAIN}
"""Codes of hardware.md 3.1: (argument follows the command, supplement follows the answer)."""


@pytest.mark.parametrize("code", range(64))
def test_only_commands_that_exist_are_answered(code: int) -> None:
    line = Line(5, clock_hz=SLOW_HZ)
    if code in MODES:
        argument, supplement = MODES[code]
        bits = line.master.exchange(0, code, 0 if argument else None, 29, 0 if supplement else None)
        assert len(bits) == 29
        assert (at.MODES[code].argument, at.MODES[code].supplement) == (bool(argument), bool(supplement))
        return
    with pytest.raises(EndatError, match="no start bit within 24000000 ns"):  # twice t_ac
        line.master.exchange(0, code, None, 36)
    assert line.encoder.level(line.master.t_ns + 1) == 0
    assert line.master.position(line.next_ns).value == 5


def test_2_1_commands_are_three_bits_and_their_complement_2_2_three_bits_twice() -> None:
    old = {code for code in range(64) if code >> 3 == 7 ^ (code & 7)} - {0b111000}
    new = {code for code in range(64) if code >> 3 == code & 7}
    assert set(at.MODES) - {0b111000} <= old | new
    assert all(code in new for code, mode in at.MODES.items() if mode.supplement)


def test_a_position_in_2_1_has_one_error_bit() -> None:
    line = Line(0x0ABCDEF)
    value, alarm, infos, _ = line.master.position(0, at.SEND_POSITION)
    assert (value, alarm, infos) == (0x0ABCDEF, False, ())
    line.encoder.answers.memory.raise_alarm(Alarm.BATTERY)
    assert line.master.position(line.next_ns, at.SEND_POSITION).alarm


@pytest.mark.parametrize(
    ("flags", "alarm"), [((0, 1), False), ((1, 0), True), ((0, 0), True), ((1, 1), True)]
)
def test_error_bits_that_agree_are_an_alarm(flags: tuple[int, int], alarm: bool) -> None:
    line = Line(0)
    frame = [*flags, *[0] * 29]
    frame += crc_bits(frame)
    line.master.line = lambda index, _level: frame[index]
    assert line.master.position(0).alarm == alarm


def test_memory_identifies_the_encoder() -> None:
    line = Line(clock_hz=SLOW_HZ)
    master = line.master

    def read(area: int, word: int) -> int:
        assert master.parameter(line.next_ns, at.SELECT_MEMORY, area) == (area, 0)
        head, data = master.parameter(line.next_ns, at.SEND_PARAMETER, word)
        assert head == word
        return data

    assert read(0xA1, 13) & 0x3F == 29
    assert read(0xA1, 14) == 0x8000
    assert read(0xA3, 1) == 0
    assert read(0xA3, 4) | read(0xA3, 5) << 16 == 1 << 29
    assert read(0xA5, 5) & 3 == 1  # EnDat 2.2
    assert read(0xB9, 0) == 0
    assert read(0xA7, 3) == 0
    assert read(0xA1, 99) == 0


def test_what_may_be_written() -> None:
    line = Line(clock_hz=SLOW_HZ)
    master = line.master
    for area, kept in ((0xA7, True), (0xA9, True), (0xAB, True), (0xAD, True), (0xBF, True), (0xA1, False),
                       (0xA3, False), (0xA5, False), (0xBD, False)):  # fmt: skip
        master.parameter(line.next_ns, at.SELECT_MEMORY, area)
        assert master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 2, 0xBEEF) == (2, 0xBEEF if kept else 0)
        assert master.parameter(line.next_ns, at.SEND_PARAMETER, 2) == (2, 0xBEEF if kept else 0)
    before = line.encoder.answers.memory.area
    master.parameter(line.next_ns, at.SELECT_MEMORY, 0x77)
    assert line.encoder.answers.memory.area == before


def test_alarms_and_warnings_are_cleared_whole_by_writing_0() -> None:
    line = Line(clock_hz=SLOW_HZ)
    memory = line.encoder.answers.memory
    memory.raise_alarm(Alarm.LIGHT | Alarm.POSITION)
    memory.raise_alarm(Alarm.AMPLITUDE)
    memory.raise_warning(2)
    memory.raise_warning(1)
    line.master.parameter(line.next_ns, at.SELECT_MEMORY, 0xB9)
    assert line.master.parameter(line.next_ns, at.SEND_PARAMETER, 0) == (0, 7)
    assert line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 0, 1) == (0, 7)
    assert line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 0, 0) == (0, 0)
    assert not line.master.position(line.next_ns).alarm
    assert line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 1, 0) == (1, 0)
    assert memory.warnings == 0
    assert line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 4, 7) == (4, 0)


def test_power_up_alarms_and_error_reset() -> None:
    encoder = ClockedEncoder(lambda _t: 1)
    master = ClockedMaster(encoder)
    assert master.position(0).alarm
    assert master.position(1 * MS, at.POSITION_ERROR_RESET, supplement=0).alarm
    assert not master.position(2 * MS).alarm


def select(line: Line, *codes: int) -> None:
    for code in codes:
        infos = sum(each is not None for each in (line.encoder.answers._info_1, line.encoder.answers._info_2))
        line.master.position(line.next_ns, at.POSITION_SELECT, infos, code << 16)


def test_additional_information_2_comes_before_1_and_one_transfer_later() -> None:
    line = Line(0x12345678)
    assert line.master.position(line.next_ns, at.POSITION_SELECT, 0, 0x42 << 16).infos == ()
    first = line.master.position(line.next_ns, at.POSITION_SELECT, 1, 0x59 << 16).infos
    assert first == (0x42 & 0x1F | 0x40) << 16 | 0x5678 or first == ((0x02 | 0x40) << 16 | 0x5678,)
    both = line.master.position(line.next_ns, infos=2).infos
    assert both == ((0x19 | 0x40) << 16, (0x02 | 0x40) << 16 | 0x5678)
    select(line, 0x4F)
    assert line.master.position(line.next_ns, infos=1).infos == ((0x19 | 0x40) << 16,)
    select(line, 0x5F)
    bits = line.master.exchange(line.next_ns, at.SEND_POSITION_INFO, None, 60)
    assert bits[36:] == [bits[35]] * 24  # nothing follows: the last bit stays while clocks do


def test_an_additional_information_begins_with_a_start_bit() -> None:
    line = Line(0)
    select(line, 0x42)
    bits = line.master.exchange(line.next_ns, at.SEND_POSITION_INFO, None, 66)
    assert bits[36:61] == [1, *map(int, f"{0x40 | 0x02:08b}"), *[0] * 16]


@pytest.mark.parametrize(
    ("info", "word"),
    [
        (0x40, 0), (0x42, 0x5678), (0x43, 0x1234), (0x44, 0), (0x47, 0xA1), (0x48, 0x33), (0x49, 0x8899),
        (0x4A, 0x6677), (0x4B, 0x55), (0x4C, 2932), (0x41, 0), (0x4E, 0), (0x50, 0), (0x51, 0), (0x59, 0x40),
    ],
)  # fmt: skip
def test_contents(info: int, word: int) -> None:
    line = Line(0x12345678 - (1 << 29), clock_hz=SLOW_HZ)  # what a position wraps to
    line.encoder.answers.test_values = 0x5566778899
    line.encoder.answers.memory.raise_alarm(Alarm.BATTERY)
    line.master.parameter(line.next_ns, at.RECEIVE_TEST, 0x33)
    line.master.parameter(line.next_ns, at.SELECT_MEMORY, info)
    (told,) = line.master.position(line.next_ns, infos=1).infos
    assert told == (info & 0x1F | 0x40) << 16 | word


def test_status_byte_warns_and_is_busy() -> None:
    line = Line(1)
    select(line, Info.MEMORY_LSB)
    line.encoder.answers.memory.raise_warning(2)
    (told,) = line.master.position(line.next_ns, at.POSITION_SEND, 1, 13 << 16).infos
    assert told >> 16 == 0x80 | 0x40 | 5
    (told,) = line.master.position(line.next_ns, infos=1).infos
    assert told == (0x80 | 0x40 | 0x20 | 5) << 16 | 13 << 8 | 29
    (told,) = line.master.position(line.next_ns + 12 * MS, at.POSITION_SELECT, 1, 0x46 << 16).infos
    assert told >> 16 == 0x80 | 0x40 | 5
    (told,) = line.master.position(line.next_ns, infos=1).infos
    assert told == (0x80 | 0x40 | 6) << 16 | 13 << 8


def test_a_memory_access_is_over_at_its_12_ms() -> None:
    answers = Answers()
    answers.supplement(0, at.POSITION_SELECT, Info.MEMORY_LSB << 16)
    answers.supplement(0, at.POSITION_SEND, 13 << 16)
    mode = at.MODES[at.SEND_POSITION_INFO]
    for t_ns, busy in ((12 * MS - 1, 1), (12 * MS, 0)):
        assert answers.bits(t_ns, at.SEND_POSITION_INFO, mode, 0, 0)[36 + 1 + 2] == busy


def test_parameters_written_beside_positions() -> None:
    line = Line(1)
    select(line, 0xA7)
    line.master.position(line.next_ns, at.POSITION_RECEIVE, 0, 3 << 16 | 0xCAFE)
    select(line, Info.MEMORY_MSB)
    (told,) = line.master.position(line.next_ns, at.POSITION_SEND, 1, 3 << 16).infos
    assert told >> 16 == 0x40 | 0x20 | 6  # still writing
    (told,) = line.master.position(line.next_ns + 12 * MS, infos=1).infos
    assert told & 0xFFFF == 3 << 8 | 0xCA
    line.master.position(line.next_ns, at.POSITION_TEST, 1, 0x21 << 16)
    select(line, Info.TEST_ACKNOWLEDGE)
    assert line.master.position(line.next_ns, infos=1).infos[0] & 0xFFFF == 0x21


def test_a_supplement_waits_for_its_start_bit() -> None:
    line = Line(7)
    master = line.master
    master.exchange(0, at.POSITION_SELECT, None, 36)
    master._clock(0)
    for _ in range(6):
        master._clock(0)
    for bit in (1, *[int(b) for b in f"{0x42:08b}{0:016b}"]):
        master._clock(bit)
    assert line.encoder.phase is Phase.DONE
    assert line.master.position(line.next_ns, infos=1).infos == (0x42 << 16 | 7,)


def test_test_values() -> None:
    line = Line()
    line.encoder.answers.test_values = 0x8123456789
    assert line.master.test_values(0) == (False, 0x8123456789)
    line.encoder.answers.memory.raise_alarm(1)
    assert line.master.test_values(line.next_ns) == (True, 0x8123456789)


def test_a_reset_is_a_power_cycle_and_takes_50_ms() -> None:
    line = Line(3, clock_hz=SLOW_HZ)
    memory = line.encoder.answers.memory
    select(line, 0x42, 0x59)
    line.master.parameter(line.next_ns, at.RECEIVE_TEST, 0x33)
    line.master.position(line.next_ns, at.POSITION_SEND, 2, 13 << 16)
    line.master.parameter(line.next_ns, at.SELECT_MEMORY, 0xB9)
    line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 3, 1)
    memory.raise_warning(2)
    line.master.parameter(line.next_ns, at.RECEIVE_RESET, 0)
    with pytest.raises(EndatError, match="no start bit"):
        line.master.position(line.next_ns + 20 * MS)
    told = line.master.position(line.next_ns + 40 * MS)
    assert (told.value, told.alarm, told.infos) == (3, True, ())
    assert (memory.area, memory.warnings, line.encoder.recovery_ns) == (0xA1, 0, 20_000)
    for info in (0x48, 0x45, 0x49):  # test port, parameter, test values
        select(line, info)
        assert line.master.position(line.next_ns, infos=1).infos == ((info & 0x1F | 0x40) << 16,)


def test_a_reset_is_silent_for_50_ms_after_its_answer() -> None:
    answers = Answers()
    answers.power_up(7)
    assert answers.silent_until_ns == 7 + 12 * MS + 50 * MS


def test_numbers_of_areas_contents_and_alarms() -> None:
    assert [*at.Area] == [0xA1, 0xA3, 0xA5, 0xA7, 0xA9, 0xAB, 0xAD, 0xB9, 0xBD, 0xBF]
    assert [*Info] == [0x40, 0x42, 0x43, *range(0x45, 0x4D), 0x4F, 0x50, 0x59, 0x5F]
    assert [*Alarm] == [1 << bit for bit in range(7)]


def test_memory_access_takes_12_ms_and_positions_5_us() -> None:
    line = Line()
    line.master.parameter(0, at.SEND_PARAMETER, 13)
    # 2 + 6 + 24 + 2 clocks, t_ac, start and 29 bits at 1 MHz
    assert line.master.t_ns == pytest.approx(12 * MS + (34 + 30) * 1000, abs=1000)


def test_the_line_falls_after_the_recovery_time() -> None:
    line = Line((1 << 29) - 1)
    line.master.position(0)
    end = line.master.t_ns
    last_rise = end - 500
    assert line.encoder.level(last_rise + 19_999) == 0  # last CRC bit of this frame is 0
    line.value = 123456789  # CRC 19 (hardware.md 3.1), whose last bit is 1
    line.master.position(line.next_ns)
    rise = line.master.t_ns - 500
    assert line.encoder.level(rise + 19_999) == 1
    assert line.encoder.level(rise + 20_000) == 0


@pytest.mark.parametrize("bits", [0, 1])
def test_a_transfer_within_the_recovery_time_is_not_heard(bits: int) -> None:
    line = Line(5)
    if bits:  # word 3 of B9 selects the short one, 1.25..3.75 us
        line.master.parameter(line.next_ns, at.SELECT_MEMORY, 0xB9)
        assert line.master.parameter(line.next_ns, at.RECEIVE_PARAMETER, 3, 1) == (3, 1)
    line.master.position(line.next_ns)
    early, late = (2_400, 2_500) if bits else (19_900, 20_000)
    rise = line.master.t_ns - 500
    assert line.encoder.recovery_ns == late
    with pytest.raises(EndatError):
        line.master.position(rise + early)
    line.master.position(line.next_ns)
    rise = line.master.t_ns - 500
    assert line.master.position(rise + late).value == 5


def test_clock_high_in_the_middle_starts_again_and_clock_low_parks() -> None:
    line = Line(9)
    for held, value in ((10_000, None), (10_001, 9)):
        encoder = line.encoder
        line.master._t_ns = line.next_ns
        for bit in (0, 0, 1, 1):
            line.master._clock(bit)
        resume = line.master._t_ns - 500 + held
        if value is None:
            with pytest.raises(EndatError):
                line.master.position(resume)  # goes on where it was: not the command that was meant
        else:
            assert line.master.position(resume).value == value
    for held, fits in ((50 * MS, True), (50 * MS + 1, False)):
        start = line.next_ns
        line.latches.clear()
        encoder.edge(start, 0, 0)
        encoder.edge(start + held, 1, 0)
        assert encoder.phase is (Phase.COMMAND if fits else Phase.IDLE)
        assert encoder.level(start + held) == int(fits)  # at rest the line is low
        line.master._t_ns = start + held + 100_000


@pytest.mark.parametrize(("delay", "good"), [(0, True), (300, True), (499, True), (700, False)])
def test_a_cable_longer_than_half_a_clock_needs_compensation(delay: int, good: bool) -> None:
    line = Line(0x0AAAAAAA, delay_ns=delay)
    if good:
        assert line.master.position(0).value == 0x0AAAAAAA
        return
    with contextlib.suppress(EndatError):
        assert line.master.position(0).value != 0x0AAAAAAA


@pytest.mark.parametrize("clock_hz", [100_000, 500_000, 2_000_000])
def test_other_clocks(clock_hz: int) -> None:
    line = Line(0x0ABCDEF, clock_hz=clock_hz)
    assert line.master.position(0).value == 0x0ABCDEF


@given(positions, st.integers(0, 35))
def test_a_disturbed_bit_is_refused(position: int, wrong: int) -> None:
    line = Line(position)
    line.master.line = lambda index, level: level ^ (index == wrong)
    with pytest.raises(EndatError, match="CRC of 31 bits"):
        line.master.position(0)


def test_no_edge_is_no_clock() -> None:
    line = Line(1)
    for t_ns in range(0, 1000, 100):
        line.encoder.edge(t_ns, 1, 1)
    assert line.encoder.phase is Phase.IDLE
    assert line.encoder.level(0) == 0
