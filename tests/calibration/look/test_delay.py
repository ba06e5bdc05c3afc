"""Which of two delays is taken: beside any friction curve, or beside the declared terms alone."""

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from calibration.finding import NORMAL
from calibration.look.delay import _settled
from calibration.names.channel_delay import late_column

CURVE_S, DECLARED_S, ERROR_S = -0.024, -0.010, 0.001
BEFORE = 10.0
ROWS = np.ones(4, dtype=bool)


def made(delay_s: float) -> Any:
    """A balance whose declared terms leave least at DECLARED_S."""
    left = np.full(4, 1.0 + abs(delay_s - DECLARED_S))
    return SimpleNamespace(delay_s=delay_s, train=ROWS, plain_fit=lambda rows: ({}, left))


def taken(curve: tuple[float, int], declared: tuple[float, int]) -> tuple[float, Any]:
    """The delay, s, and its finding, by what is left beside each with so many names."""

    def find(p: Any) -> Any:
        after, names = curve if p.delay_s == CURVE_S else declared
        s = SimpleNamespace(held=SimpleNamespace(after=after), left=after**2, chosen=[None] * names)
        return s, None, []

    first = late_column("late", CURVE_S, ERROR_S)
    bare: Any = SimpleNamespace(held=SimpleNamespace(before=BEFORE))
    found, balance, _ = _settled(first, bare, made, find)
    assert found.parameters["delay"].value == pytest.approx(balance.delay_s)
    return float(balance.delay_s), found


@pytest.mark.parametrize(
    ("curve", "declared", "second"),
    [
        ((5.0, 2), (4.9, 2), True),  # less is left
        ((5.0, 2), (5.1, 2), False),
        # of 75 that the first takes, nine tenths are 67.5: an rms of 5.7 is left
        ((5.0, 2), (5.6, 1), True),
        ((5.0, 2), (5.8, 1), False),
        ((5.0, 1), (5.6, 2), False),
    ],
)
def test_the_delay_that_leaves_less_or_as_much_with_fewer_names(
    curve: tuple[float, int], declared: tuple[float, int], second: bool
) -> None:
    delay_s, found = taken(curve, declared)
    assert delay_s == pytest.approx(DECLARED_S if second else CURVE_S, abs=1e-4)
    if second:  # half of what the two are apart
        p = found.parameters["delay"]
        assert p.high - p.value == pytest.approx(NORMAL * np.hypot(ERROR_S, 0.007), rel=0.02)
