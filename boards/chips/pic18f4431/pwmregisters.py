"""Registers of the PIC18F4431's power control PWM as tables (DS39616D section 18; field positions K).

field -> (register, shift, bits).
"""

FIELDS: dict[str, tuple[str, int, int]] = {
    "PTOPS": ("PTCON0", 4, 4), "PTCKPS": ("PTCON0", 2, 2), "PTMOD": ("PTCON0", 0, 2),
    "PTEN": ("PTCON1", 7, 1), "PTDIR": ("PTCON1", 6, 1),
    "PWMEN": ("PWMCON0", 4, 3), "PMOD": ("PWMCON0", 0, 4),
    "SEVOPS": ("PWMCON1", 4, 4), "SEVTDIR": ("PWMCON1", 3, 1), "UDIS": ("PWMCON1", 1, 1),
    "OSYNC": ("PWMCON1", 0, 1),
    "DTPS": ("DTCON", 6, 2), "DT": ("DTCON", 0, 6),
}  # fmt: skip
WIDTHS: dict[str, int] = {
    "PTCON0": 8, "PTCON1": 8, "PWMCON0": 8, "PWMCON1": 8, "DTCON": 8, "OVDCOND": 8, "OVDCONS": 8,
    "PTPER": 12, "SEVTCMP": 12, "PDC0": 14, "PDC1": 14, "PDC2": 14, "PDC3": 14,
}  # fmt: skip
"""Bits of each; the pairs H and L of the 12 and 14 bit ones are written as one here."""
AT_RESET: dict[str, int] = dict.fromkeys(WIDTHS, 0) | {"PTPER": 0xFFF, "OVDCOND": 0xFF, "PWMCON0": 0x50}
"""PWMPIN not programmed: the outputs are enabled."""
PTCKPS = (1, 4, 16, 64)
"""Prescaler of the time base; its clock is Fosc/4."""
DTPS = (2, 4, 8, 16)
"""Dead time clock: Fosc over this."""
PAIRS, CHANNELS = 4, 8
ENABLED: tuple[tuple[int, ...], ...] = (
    (), (1,), (1, 3), (0, 1, 2, 3), (0, 1, 2, 3, 4, 5), (0, 1, 2, 3, 4, 5, 6, 7), (1, 3, 5), (1, 3, 5, 7),
)  # fmt: skip
"""Channels that PWMEN makes PWM outputs; the others are ordinary pins."""
FREE_RUNNING, SINGLE_SHOT, UP_DOWN, UP_DOWN_TWICE = range(4)
"""PTMOD."""
PTMIF = 1
"""PIR3 bit of the time base's interrupt. K."""
