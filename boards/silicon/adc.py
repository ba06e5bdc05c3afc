"""10-bit analogue to digital converter, 5 V reference, and the current sense in front of it."""

from collections.abc import Callable
from typing import Final

REFERENCE_V: Final = 5.0
FULL_SCALE: Final = 1023
_COUNTS_PER_V: Final = 1024 / REFERENCE_V

SHUNT_OHM: Final = 0.1
"""Paper, section 3.2."""
SENSE_GAIN: Final = 8.0
"""Op-amp between shunt and converter, ASSUMPTION (hardware.md 2.3): 6 A reads 4.8 V, 6.1 mA per count."""
_COUNTS_PER_A: Final = SHUNT_OHM * SENSE_GAIN * _COUNTS_PER_V


def convert(volts: float) -> int:
    """Conversion result of a voltage at the pin, clipped to 0..1023."""
    counts = int(volts * _COUNTS_PER_V)
    return 0 if counts < 0 else FULL_SCALE if counts > FULL_SCALE else counts


class CurrentAdc:
    """Two sense channels, sampled at the falling edge of the PWM, where the current peaks (paper,
    section 3.3).

    pin: (t_ns, motor) -> A as the sense chain sees it. Motors 0 (A) and 1 (B).
    """

    def __init__(self, pin: Callable[[int, int], float]) -> None:
        self.pin = pin

    def read(self, t_ns: int, motor: int) -> int:
        """The last conversion of the motor's channel, 0..1023."""
        counts = int(self.pin(t_ns, motor) * _COUNTS_PER_A)
        return counts if 0 <= counts <= FULL_SCALE else 0 if counts < 0 else FULL_SCALE


class VoltageAdc:
    """One channel on a voltage. pin: (t_ns) -> V."""

    def __init__(self, pin: Callable[[int], float]) -> None:
        self.pin = pin

    def read(self, t_ns: int) -> int:
        """Conversion of the voltage at `t_ns`, 0..1023."""
        return convert(self.pin(t_ns))
