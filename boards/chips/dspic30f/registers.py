"""Registers of QEI, motor control PWM and ADC as tables: field -> (register, shift, bits). hardware.md 3.4; K
where that has nothing."""

from collections.abc import Mapping
from enum import IntEnum

FIELDS: dict[str, tuple[str, int, int]] = {
    "CNTERR": ("QEICON", 15, 1), "INDX": ("QEICON", 12, 1), "UPDN": ("QEICON", 11, 1),
    "QEIM": ("QEICON", 8, 3), "SWPAB": ("QEICON", 7, 1),
    "QEOUT": ("DFLTCON", 7, 1),
    "PTEN": ("PTCON", 15, 1), "PTCKPS": ("PTCON", 2, 2), "PTMOD": ("PTCON", 0, 2),
    "SEVOPS": ("PWMCON2", 8, 4),
    "DTAPS": ("DTCON1", 6, 2), "DTA": ("DTCON1", 0, 6),
    "ADON": ("ADCON1", 15, 1), "SSRC": ("ADCON1", 5, 3), "ASAM": ("ADCON1", 2, 1),
    "SAMP": ("ADCON1", 1, 1), "DONE": ("ADCON1", 0, 1),
    "CHPS": ("ADCON2", 8, 2), "SMPI": ("ADCON2", 2, 4),
    "ADCS": ("ADCON3", 0, 6),
}  # fmt: skip

PTPER_MASK = 0x7FFF
"""PTPER has 15 bits."""
PTCKPS = (1, 4, 16, 64)
"""Prescaler of PTMR's clock Fosc/4 (one instruction cycle)."""
DTAPS = (1, 2, 4, 8)
CHANNELS = (1, 2, 4, 4)
"""Sample and holds that CHPS uses."""
CONVERSION_TAD = 12


class Qeim(IntEnum):
    """QEIM of the dsPIC; any other value is off, or a timer."""

    X2_INDEX = 0b100
    X2_MATCH = 0b101
    X4_INDEX = 0b110
    X4_MATCH = 0b111


class Ssrc(IntEnum):
    """What ends sampling and starts a conversion."""

    MANUAL = 0b000
    INT0 = 0b001
    TIMER3 = 0b010
    PWM = 0b011
    AUTO = 0b111


class Registers:
    """fields: field -> (register, shift, bits). widths: bits of each register. values: after a reset."""

    def __init__(
        self,
        fields: Mapping[str, tuple[str, int, int]],
        widths: Mapping[str, int],
        values: Mapping[str, int],
    ) -> None:
        self._fields, self._widths, self._values = fields, widths, dict(values)

    def __getitem__(self, register: str) -> int:
        return self._values[register]

    def __setitem__(self, register: str, value: int) -> None:
        """Write a register; bits it does not have read as 0. Raises KeyError for one there is not."""
        self._values[register] = value & (1 << self._widths[register]) - 1

    def field(self, name: str) -> int:
        """Value of a field."""
        register, shift, bits = self._fields[name]
        return self._values[register] >> shift & (1 << bits) - 1

    def put(self, name: str, value: int) -> None:
        """Change a field; raises ValueError when it does not fit."""
        register, shift, bits = self._fields[name]
        mask = (1 << bits) - 1
        if not 0 <= value <= mask:
            raise ValueError(f"{name} has {bits} bits, {value} does not fit")
        self[register] = self._values[register] & ~(mask << shift) | value << shift


def registers(**values: int) -> Registers:
    """Registers of 16 bits and their values after a reset."""
    return Registers(FIELDS, dict.fromkeys(values, 16), values)
