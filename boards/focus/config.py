"""The focus board (PIC18F4431 at 10 MIPS) before it runs: interrupt table, pins, what it is programmed with.

Cycles are ASSUMPTIONS. The PWM channel that makes the LVDT's 2 kHz carrier runs by itself, without a routine.
"""

from collections.abc import Callable
from dataclasses import dataclass
from math import sqrt
from typing import Final

from boards.core import Source

FCY_HZ: Final = 10_000_000

TABLE: Final = (
    Source("sample", priority=3, latency_cycles=12, cost_cycles=500),  # 50 us: QEI, ADC, SPI load
    Source("step", priority=2, latency_cycles=12, cost_cycles=150),  # 15 us: table look-up, ramp, port
    Source("can", priority=1, latency_cycles=12, cost_cycles=600, level=True),
)


@dataclass(frozen=True, slots=True, kw_only=True)
class FocusPins:
    """coils: the H-bridges, (t_ns, phase 0..7, energised, hold).

    encoder: quadrature inputs, (t_ns) -> counts.
    index: the encoder's index input, (t_ns) -> bool. lvdt: ADC input, (t_ns) -> V.
    """

    coils: Callable[[int, int, bool, bool], None]
    encoder: Callable[[int], int]
    index: Callable[[int], bool]
    lvdt: Callable[[int], float]


@dataclass(frozen=True, slots=True, kw_only=True)
class FocusConfig:
    """half_steps_per_turn: of the motor (paper, 3.2: 0.9 deg). counts_per_turn: of its encoder.

    travel: largest position either side of the middle, half steps (5 mm at 6.25 um).
    index: positions of the index pulses, half steps: four, 2.5 mm apart, either side of the middle.
    start_rate, top_rate: half steps/s; ramp: half steps/s2 (ASSUMPTIONS: below the motor's pull-out).
    """

    half_steps_per_turn: int = 400
    counts_per_turn: int = 1600
    travel: int = 800
    index: tuple[int, ...] = (-600, -200, 200, 600)
    start_rate: int = 100
    top_rate: int = 400
    ramp: int = 800

    @property
    def intervals_ns(self) -> tuple[int, ...]:
        """Time between half steps along the ramp: v^2 = v0^2 + 2 a n."""
        count = (self.top_rate**2 - self.start_rate**2) // (2 * self.ramp) + 1
        rates = (sqrt(self.start_rate**2 + 2 * self.ramp * n) for n in range(count))
        return tuple(round(1e9 / rate) for rate in rates)
