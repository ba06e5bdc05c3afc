"""B1: a duty finer than a PWM step: what the registers are loaded with, and that nothing is lost."""

from itertools import accumulate, islice

from hypothesis import given
from hypothesis import strategies as st

from boards.silicon.pwm import ONE, MotorPwm
from tests.boards.silicon.spreader import Spreader

duties = st.integers(0, 3000 * ONE)


@given(duties, st.integers(0, ONE - 1), st.integers(1, 400))
def test_B1_the_registers_average_to_the_duty_at_every_moment(value: int, start: int, periods: int) -> None:
    spreader = Spreader()
    spreader.value_q16, spreader.accumulator = value, start
    registers = list(spreader.registers(periods))
    for n, total in enumerate(accumulate(registers), 1):
        assert -ONE < total * ONE - n * value < ONE  # never a step off, however long it runs
    # a PDC is 16 bit, and neighbouring periods differ by one step at most: no pulse that a switch could miss
    assert all(0 <= register <= 0xFFFF for register in registers)
    assert set(registers) <= {value // ONE, value // ONE + 1}


@given(st.lists(st.tuples(duties, st.integers(0, 300)), min_size=1, max_size=20))
def test_B1_the_average_is_exact_over_changing_duties(written: list[tuple[int, int]]) -> None:
    spreader = Spreader()
    loaded = wanted = 0
    for value, periods in written:
        spreader.value_q16 = value
        loaded += sum(spreader.registers(periods))
        wanted += value * periods
    assert loaded * ONE + spreader.accumulator == wanted  # what is not out yet is in the accumulator, exactly


def _dspic(fraction: int, whole: int, accumulator: int) -> tuple[int, int]:
    """The interrupt in 16-bit instructions: ADD accumulator, fraction; ADDC whole, #0; MOV to PDC."""
    low = accumulator + fraction
    carry = low >> 16
    return (whole + carry) & 0xFFFF, low & 0xFFFF


@given(duties, st.integers(0, ONE - 1))
def test_B1_sixteen_bit_instructions_load_the_same_registers(value: int, start: int) -> None:
    spreader = Spreader()
    spreader.value_q16 = value
    spreader.accumulator = accumulator = start
    for register in islice(spreader.registers(50), 50):
        pdc, accumulator = _dspic(value & 0xFFFF, value >> 16, accumulator)
        assert register == pdc
    assert spreader.accumulator == accumulator


def test_B1_the_switches_get_the_mean_of_the_sequence() -> None:
    driven: list[tuple[int, float, float]] = []
    pwm = MotorPwm(lambda *arguments: driven.append(arguments), steps=3000, pwm_hz=20_000)
    pwm.write_spread(0, 3 * ONE // 2, ONE // 4)
    assert driven == [(0, 0.0005, 0.25 / 3000)]


def test_B1_whole_steps_after_spread_ones_are_driven_even_when_the_register_says_so_already() -> None:
    driven: list[tuple[int, float, float]] = []
    pwm = MotorPwm(lambda *arguments: driven.append(arguments), steps=3000, pwm_hz=20_000)
    pwm.write_spread(0, ONE // 2, 0)
    pwm.write(60_000, 0, 0)
    assert driven[-1] == (100_000, 0.0, 0.0)
