"""Motor control PWM of the dsPIC30F3011: two duty registers behind one time base.

Edge aligned, duty = PDC / (2 (PTPER + 1)): bit 0 of PDC is half an instruction cycle (hardware.md 3.4).
30 MIPS and 20 kHz give PTPER = 1499 and 3000 steps. PDC = 0 is off; PDC above 2 PTPER + 1 is fully on.
A new PDC is taken at the end of the running period.
"""

from collections.abc import Callable

FCY_HZ = 30_000_000
"""dsPIC30F at its fastest. ASSUMPTION: the paper does not say."""
PWM_HZ = 20_000
"""ASSUMPTION (hardware.md 2.4): above hearing, and 3000 steps at 30 MIPS."""
_PTPER_LIMIT = 0x7FFF


def steps_for(fcy_hz: int, pwm_hz: int) -> int:
    """Duty steps of one period; raises ValueError when PTPER (15 bit) cannot hold it."""
    ptper = fcy_hz // pwm_hz - 1
    if not 0 < ptper <= _PTPER_LIMIT:
        raise ValueError(
            f"PWM of {pwm_hz} Hz at {fcy_hz} instructions/s needs PTPER = {ptper}, 1..{_PTPER_LIMIT} exist"
        )
    return 2 * (ptper + 1)


class MotorPwm:
    """Two channels. drive: the switches, (t_ns, duty_a, duty_b), duties 0..1."""

    __slots__ = ("_phase_ns", "drive", "pdc_a", "pdc_b", "period_ns", "steps")

    def __init__(
        self,
        drive: Callable[[int, float, float], None],
        steps: int = 3000,
        pwm_hz: int = PWM_HZ,
        phase_ns: int = 0,
    ) -> None:
        self.drive = drive
        self.steps = steps
        self.period_ns = 1_000_000_000 // pwm_hz
        self.pdc_a = 0
        self.pdc_b = 0
        self._phase_ns = phase_ns

    def write(self, t_ns: int, pdc_a: int, pdc_b: int) -> None:
        """Write both duty registers at `t_ns`: they count from the next period on. Negative values are a
        bug."""
        if pdc_a == self.pdc_a and pdc_b == self.pdc_b:
            return
        self.pdc_a = pdc_a
        self.pdc_b = pdc_b
        steps = self.steps
        period = self.period_ns
        # The period boundary at or after t_ns. Simplified: the time base runs on true time, not on the
        # board's crystal.
        loads = t_ns + (self._phase_ns - t_ns) % period
        self.drive(
            loads,
            pdc_a / steps if pdc_a <= steps else 1.0,
            pdc_b / steps if pdc_b <= steps else 1.0,
        )
