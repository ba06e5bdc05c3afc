"""What the PWM interrupt of the spread duty loads into a register, period by period."""

from collections.abc import Iterator

from boards.silicon.pwm import ONE

_MASK = ONE - 1


class Spreader:
    """One channel of a duty finer than a PWM step: the fraction is spread over successive periods
    (first-order delta-sigma).

    Once a period the PWM interrupt adds the fraction to a 16-bit accumulator and loads the whole steps plus
    the carry. Over n periods the registers sum up to n times the wanted value, to within one step.
    `value_q16`: the wanted register value, PWM steps in Q16. `accumulator`: 16 bit.
    """

    def __init__(self) -> None:
        self.value_q16 = 0
        self.accumulator = 0

    def registers(self, periods: int) -> Iterator[int]:
        """The values the interrupt loads in the next `periods` PWM periods, one by one."""
        whole, fraction = divmod(self.value_q16, ONE)
        for _ in range(periods):
            total = self.accumulator + fraction
            self.accumulator = total & _MASK
            yield whole + (total >> 16)
