"""Rows of an axis log whose clock or numbers are in no unit of the format, each with its line."""

from math import inf, nan

import numpy as np
import pytest

from calibration.inputs.axislog import (
    _check_time,
    _check_values,
    _fractions,
)
from tests.calibration.inputs.test_axislog import PATH, refused

EVEN = np.arange(102.0)


def repeated(count: int) -> np.ndarray:
    """A hundred steps, of which so many are none."""
    return np.cumsum(np.where(np.arange(101) % 100 < 100 - count, 1.0, 0.0))


@pytest.mark.parametrize(
    ("t", "period", "says"),
    [
        ([0.0, 1.0, nan], 1.0, "a.log:14: column 't': is empty"),
        ([0.0, inf, 2.0], 1.0, "a.log:13: column 't': is infinite"),
        ([0.0, 1.0, 0.5], 1.0, ""),  # half a period back
        ([0.0, 1.0, 0.49], 1.0, "a.log:14: column 't': time goes backwards from 1 s to 0.49 s"),
        ([0.0, 4.0, 3.1, 9.0], 2.0, ""),
        (100 * EVEN[:21], 1.0, ""),  # twenty steps
        (
            100 * EVEN[:22],
            1.0,
            "a.log:12: column 't': rows are 100 apart, the header says 1 s: 't' is logged in s",
        ),
        (0.01 * EVEN, 0.01, ""),
        (19.9 * EVEN, 1.0, ""),
        (
            20.0 * EVEN,
            1.0,
            "a.log:12: column 't': rows are 20 apart, the header says 1 s: 't' is logged in s",
        ),
        (0.051 * EVEN, 1.0, ""),
        (
            0.05 * EVEN,
            1.0,
            "a.log:12: column 't': rows are 0.05 apart, the header says 1 s: 't' is logged in s",
        ),
        (repeated(30), 1.0, ""),
        (
            repeated(31),
            1.0,
            "a.log:81: column 't': a third of the rows share their time with the row before: "
            "two axes in one file?",
        ),
    ],
)
def test_the_clock_is_in_s_and_goes_on(t: list[float], period: float, says: str) -> None:
    if says:
        assert refused(_check_time, PATH, np.array(t), period, 12) == says
    else:
        _check_time(PATH, np.array(t), period, 12)


def values(rows: int = 100, **columns: float | list[float]) -> dict[str, np.ndarray]:
    """Whole numbers, all but those given."""
    return {"position": np.full(rows, 7.0), "effort": np.full(rows, 100.0)} | {
        name: np.resize(np.array(x, dtype=float), rows) for name, x in columns.items()
    }


VOLTS = "a.log:12: column 'effort': never exceeds 12.5: it is logged in "
VOLTS += "1/3000 of the supply, not in V or as a fraction"


@pytest.mark.parametrize(
    ("raw", "says"),
    [
        (values(), ""),
        (values(adc_a=[1.0, inf]), "a.log:13: column 'adc_a': is infinite"),
        (values(effort=nan), "a.log:12: column 'effort': holds no number in any row"),
        (values(position=nan), "a.log:12: column 'position': holds no number in any row"),
        (values(position=[0.0, 2.0**40]), ""),
        (values(position=[0.0, -(2.0**40) - 1]), "a.log:13: column 'position': is beyond any 29-bit counter"),
        (values(effort=[0.0, 3150.0]), ""),
        (values(effort=[0.0, -3151.0]), "a.log:13: column 'effort': is beyond full scale (3000)"),
        (values(position=0.5), "a.log:12: column 'position': holds fractions: it is logged in "
                               "29-bit counts, not in an angle"),
        (values(99, position=0.5), ""),
        (values(position=[0.5, 1.0]), ""),  # half of them are whole
        (values(position=1_999_999.5), "a.log:12: column 'position': holds fractions: it is "
                                       "logged in 29-bit counts, not in an angle"),
        (values(position=[0.5, 0.25, 2e6]), ""),
        (values(effort=12.5, position=[-500.0, 501.0]), VOLTS),
        (values(effort=12.5, position=[500.0, 1500.0]), ""),
        (values(effort=[29.9, 30.0, 0.5], position=[-500.0, 501.0]), ""),
        (values(effort=12.0, position=[-500.0, 501.0]), ""),
    ],
)  # fmt: skip
def test_numbers_are_in_the_formats_units(raw: dict[str, np.ndarray], says: str) -> None:
    if says:
        assert refused(_check_values, PATH, raw, 3000.0, 12) == says
    else:
        _check_values(PATH, raw, 3000.0, 12)


def test_fractions_are_more_than_half_of_the_numbers() -> None:
    found = [_fractions(np.array(x)) for x in ([0.5, 1.5, 2.0], [0.5, 2.0], [nan, 0.5], [nan], [3.0])]
    assert found == [True, False, True, False, False]
