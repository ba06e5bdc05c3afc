"""Noise of the instruments the authors read: nothing the firmware sees, only what is in the log."""

from dataclasses import replace

import numpy as np

from bus.time.randomness import generator
from scenarios.studies.paper.friction_map import DataSheet
from scenarios.studies.paper.log import Array, Log

ADC_NOISE = 1.0
"""Counts rms on every current sample: 6.1 mA of 6 A. ASSUMPTION: one count of a 10-bit converter beside a
PWM."""
GAIN_NOISE = 0.01
"""Share of the reading, rms, from sample to sample: brush noise. ASSUMPTION."""
CONSTANT_ERROR = 0.05
"""Share by which a motor's torque constant may be off its data sheet, either way."""


class Noise:
    """Sensor noise by a seed, and one error of the torque constant, up to a share, for all its logs."""

    def __init__(self, seed: int, name: str, constant_error: float = CONSTANT_ERROR) -> None:
        self._random = generator(seed, f"paper.noise.{name}")
        self.constant = 1.0 + constant_error * (2.0 * float(self._random.random()) - 1.0)

    def log(self, log: Log) -> Log:
        """Return the log with noise on both currents, in whole counts."""

        def noisy(counts: Array) -> Array:
            drawn = self._random.standard_normal((2, counts.size))
            read = counts * (1.0 + GAIN_NOISE * drawn[0]) + ADC_NOISE * drawn[1]
            return np.asarray(np.clip(np.rint(read), 0, 1023), dtype=np.float64)

        return replace(log, adc_a=noisy(log.adc_a), adc_b=noisy(log.adc_b))

    def sheet(self, sheet: DataSheet) -> DataSheet:
        """Return a data sheet whose torque constant is not quite the motor's."""
        return replace(sheet, torque_constant=sheet.torque_constant * self.constant)
