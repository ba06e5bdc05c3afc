"""What a family hands over: files, a rig file, and what is hidden."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Rng = np.random.Generator
TURN = 2.0 * np.pi


@dataclass
class Hidden:
    """One effect as the truth file has it.

    alike: other names that pass for it. confounded: names that this log cannot tell from it; they pass when
    the answer's class has the true name, too.
    """

    name: str
    channel: str
    domain: tuple[str, ...]
    alike: tuple[str, ...] = ()
    confounded: tuple[str, ...] = ()
    stage: str | None = None
    raw: dict[str, float] = field(default_factory=dict)

    def truth(self, ratio: float, reached: float) -> dict[str, Any]:
        """The entry of the truth file."""
        return {
            "name": self.name, "class": [self.name, *self.alike], "confounded": list(self.confounded),
            "stage": self.stage, "channel": self.channel, "domain": list(self.domain), "ratio": ratio,
            "measured_ratio": reached, "reached": reached, "parameters": {}, "raw": self.raw,
            "in_catalogue": not self.name.startswith("outside"),
        }  # fmt: skip


@dataclass
class Made:
    """files: name -> text. rig: text, or None where the log needs none."""

    files: dict[str, str]
    rig: str | None
    hidden: Hidden | None
    reached: float
    drive: dict[str, Any]


def clock(rows: int, period_s: float) -> Array:
    """Seconds of every row."""
    return np.asarray(np.arange(rows) * period_s, dtype=np.float64)


def wide(rng: Rng, low: float, high: float) -> float:
    """Drawn evenly in the logarithm."""
    return float(low * (high / low) ** rng.random())


def pick(rng: Rng, *of: float) -> float:
    """One of several."""
    return float(of[int(rng.integers(len(of)))])
