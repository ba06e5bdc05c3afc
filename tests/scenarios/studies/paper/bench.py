"""A bench that writes its commands down, logs made by arithmetic, and starts on it."""

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any

import numpy as np
import pytest

from plant.model import load
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, COUNT_RATE, LOG_PERIOD_S
from scenarios.studies.paper.starts import Benches, Start

Asked = tuple[str, float, float]
"""Which loop, the set point (arcsec/s) or the effort, and for how long, s."""
LOW = load("low_preload_bridge")
HIGH = load("high_preload_bridge")


def log_of(
    rate: Array | float,
    seconds: float = 1.0,
    effort: Array | float = 0.0,
    amperes: tuple[Array | float, Array | float] = (0.0, 0.0),
    true: Array | float | None = None,
) -> Log:
    """A log in which each number stands for a whole column. rate, true: arcsec/s; amperes: of A and of B."""
    t_s: Array = np.asarray(np.arange(round(seconds / LOG_PERIOD_S)) * LOG_PERIOD_S, dtype=np.float64)

    def column(values: Array | float) -> Array:
        return np.array(np.broadcast_to(values, t_s.shape), dtype=np.float64)

    a, b = (column(each) / ADC_A_PER_COUNT for each in amperes)
    return Log(t_s, column(rate) / COUNT_RATE, column(effort), a, b, column(rate if true is None else true))


def near(value: float) -> Any:
    """Compares as `value` does, but for rounding."""
    return pytest.approx(value)


@dataclass
class StubBench:
    """Answers each command with a log."""

    answer: Callable[[str, float, float], Log]
    asked: list[Asked] = field(default_factory=list)

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """The loop closed."""
        return self._asked("closed", arcsec_s, seconds)

    def open_loop(self, effort: int, seconds: float) -> Log:
        """The loop opened."""
        return self._asked("open", effort, seconds)

    def _asked(self, loop: str, value: float, seconds: float) -> Log:
        self.asked.append((loop, value, seconds))
        return self.answer(loop, value, seconds)


def benches(answer: Callable[[str, float, float], Log]) -> Benches:
    """Stub benches of both preloads."""
    return Benches(lambda *_: StubBench(answer), {"low": LOW, "high": HIGH}, Start(180.0, 1))
