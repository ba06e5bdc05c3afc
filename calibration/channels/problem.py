"""One channel of residual as a regression: what is measured, what the declared model explains, where rows
belong."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.readers.run import Array
from calibration.statistics.whitening import Mask


@dataclass
class Problem:
    """y (n,) = base (n, p) beta + effects + noise, in `unit`, on a regular grid of `period_s` with gaps in
    `valid`.

    `run` and `session` are integer labels per row; `held` marks the held-out rows. `floor` is the rms that
    the
    sensors' own quantisation and noise leave in y, same unit.
    """

    channel: str
    unit: str
    y: Array
    base: Array
    base_labels: list[tuple[str, str]]
    t: Array
    run: NDArray[np.int64]
    session: NDArray[np.int64]
    valid: Mask
    held: Mask
    period_s: float
    floor: float = 0.0
    ar_order: int = 8
    block_s: float = 4.0
    domains: dict[str, Array] = field(default_factory=dict)
    sensor: str = "torque"  # the row of report.json's error table: torque, velocity or position
    step: float = 0.0  # rms that an effect must take away: less is within the sensor's own steps
    resolved: tuple[Mask, float] | None = None  # rows that a sensor's coarse steps do not spoil, floor there
    base_phases: tuple[slice, ...] = ()  # columns of `base` whose phase is every run's own
    fresh: Array | None = None  # columns of nuisances refitted on held-out rows (an offset per segment)

    @property
    def block(self) -> int:
        """Rows per block of the bootstrap."""
        return max(round(self.block_s / self.period_s), 4)

    @property
    def train(self) -> Mask:
        """Valid rows that may be fitted."""
        return self.valid & ~self.held

    @property
    def test(self) -> Mask:
        """Valid rows that may only be looked at."""
        return self.valid & self.held
