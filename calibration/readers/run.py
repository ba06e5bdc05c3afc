"""One run as the rest of the tool sees it: columns in SI units on the log's own clock."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass
class Run:
    """One log file (or one section of it).

    `columns` hold SI units: `t` s, `position`/`aux` rad (unwrapped), `velocity` rad/s at the axis, `effort`
    as a
    signed fraction of the supply, `current_a/b` A, `motor_a/b` rad/s at the motor, `setpoint` rad/s,
    `supply` V,
    `temperature` degree C. `raw` keeps the columns as logged, in counts.
    """

    name: str
    path: Path
    session: str
    columns: dict[str, Array]
    raw: dict[str, Array] = field(default_factory=dict)
    header: dict[str, str] = field(default_factory=dict)
    scales: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def rows(self) -> int:
        """Number of rows."""
        return len(self.columns["t"])

    @property
    def duration_s(self) -> float:
        """Time from the first to the last row in s."""
        t = self.columns["t"]
        return float(t[-1] - t[0]) if len(t) > 1 else 0.0

    def has(self, *names: str) -> bool:
        """True when every named column is there and carries numbers."""
        return all(n in self.columns and bool(np.isfinite(self.columns[n]).any()) for n in names)
