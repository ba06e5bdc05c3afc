"""Motor control PWM of the dsPIC30F3011: two duty registers behind one time base.

Edge aligned, duty = PDC / (2 (PTPER + 1)): bit 0 of PDC is half an instruction cycle (hardware.md 3.4).
30 MIPS and 20 kHz give PTPER = 1499 and 3000 steps. PDC = 0 is off; PDC above 2 PTPER + 1 is fully on.
A new PDC is taken at the end of the running period.

`write` is what firmware does once a control tick. With `write_spread` the PWM interrupt changes the registers
every period. It adds the fraction of a step to a 16-bit accumulator and loads the whole steps plus the carry.
"""

from collections.abc import Callable
from typing import Final

ONE: Final = 1 << 16

FCY_HZ: Final = 30_000_000
"""dsPIC30F at its fastest. ASSUMPTION: the paper does not say."""
PWM_HZ: Final = 20_000
"""ASSUMPTION (hardware.md 2.4): above hearing, and 3000 steps at 30 MIPS."""
STEPS: Final = 2 * FCY_HZ // PWM_HZ
"""3000, of one period."""


class MotorPwm:
    """Two channels. drive: the switches, (t_ns, duty_a, duty_b), duties 0..1."""

    def __init__(
        self, drive: Callable[[int, float, float], None], steps: int = STEPS, pwm_hz: int = PWM_HZ
    ) -> None:
        self.drive = drive
        self.steps = steps
        self.period_ns = 1_000_000_000 // pwm_hz
        self.pdc_a = 0
        self.pdc_b = 0
        self.spreading = False

    def write(self, t_ns: int, pdc_a: int, pdc_b: int) -> None:
        """Write both duty registers at `t_ns`: they count from the next period. Negative values are a bug."""
        if pdc_a == self.pdc_a and pdc_b == self.pdc_b and not self.spreading:
            return
        self.spreading = False
        self.pdc_a = pdc_a
        self.pdc_b = pdc_b
        steps = self.steps
        period = self.period_ns
        # The period boundary at or after t_ns. Simplified: the time base runs on true time, not on the
        # board's crystal.
        loads = t_ns + -t_ns % period
        self.drive(
            loads,
            pdc_a / steps if pdc_a <= steps else 1.0,
            pdc_b / steps if pdc_b <= steps else 1.0,
        )

    def write_spread(self, t_ns: int, a_q16: int, b_q16: int) -> None:
        """Write both duties in PWM steps, Q16, at `t_ns`; the PWM interrupt spreads the fractions.

        Simplified: the switches get the mean of the register sequence instead of 20 000 changes a second.
        """
        loads = t_ns + -t_ns % self.period_ns
        self.spreading = True
        self.pdc_a, self.pdc_b = a_q16 >> 16, b_q16 >> 16
        full = self.steps * ONE
        self.drive(loads, a_q16 / full if a_q16 <= full else 1.0, b_q16 / full if b_q16 <= full else 1.0)
