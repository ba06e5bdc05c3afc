"""Registers of QEI, motor control PWM and ADC as tables: field -> (register, shift, bits). hardware.md 3.4; K
where that has nothing."""

from enum import IntEnum

from boards.chips.registers import Registers

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


def registers(**values: int) -> Registers:
    """Registers of 16 bits and their values after a reset."""
    return Registers(FIELDS, dict.fromkeys(values, 16), values)
