"""Interrupt table of the axis board, dsPIC30F3011 at 30 MIPS. Cycles are ASSUMPTIONS, estimated from
instruction counts.

The PWM-triggered ADC and the UART FIFO take their cycles inside the figures below instead of rows of
their own. 20 000 ADC interrupts a second would add nothing to the last conversion before the tick.
"""

from typing import Final

from boards.core import Source
from boards.core.resources import COMMANDS, DSPIC30F3011, Ledger, line
from bus.protocol import HARMONICS, Device

FCY_HZ: Final = 30_000_000

TABLE: Final = (
    Source(
        "control", priority=6, latency_cycles=9, cost_cycles=1200
    ),  # 40 us: QEI, PI (32-bit errors, 64-bit products), PWM, SPI load of a frame
    Source(
        "can", priority=4, latency_cycles=9, cost_cycles=900, level=True
    ),  # 30 us: SPI read, dispatch, SPI load
)

PWM_ROUTINE: Final = Source("pwm", priority=7, latency_cycles=5, cost_cycles=20)
"""Only with the spread duty: per channel load, add, load, add with carry, store (10 cycles for two), flag,
shadow registers, return. Every PWM period, 1.7 % of the processor's time."""
HARMONIC_CYCLES: Final = 120
"""Per line of the compensation: 32 x 29 bit product for the phase (45), table with two interpolations (30),
two products and sums (35)."""
FRICTION_CYCLES: Final = 60
"""The friction model: two 32-bit products, sums."""
PARAMETERS: Final = 42
"""Rows of the parameter table, 32 bits each."""
LEDGER: Final = Ledger(
    chip=DSPIC30F3011,
    buffers=COMMANDS | line(Device.AXIS_RA) | {"parameters": 4 * PARAMETERS},
    table=TABLE,
    fcy_hz=FCY_HZ,
    window_ns=5_000_000,
    extra_cycles=HARMONICS * HARMONIC_CYCLES + FRICTION_CYCLES,
)
"""More RAM than the chip has: samples and packets of nine columns do not fit (FIDELITY.md, B1). Lock, blend,
gusts, bias and smoothed share book no cycles."""
