"""Declared terms are not exact: what has no name and is small beside them is their own error."""

from dataclasses import replace

import numpy as np
import pytest

from calibration.decide.drive import within_own_errors
from calibration.decide.rules import leave_out
from calibration.decide.scan import fit_with
from calibration.decide.selection import Selection
from calibration.finding import UNKNOWN
from tests.calibration.decide.made import problem, term

ROWS, CARRIED, NOISE = 2400, 10.0, 0.05
DECLARED, SHAPE = np.random.default_rng(5).standard_normal((2, ROWS, 1))


def chosen(size: float, name: str = UNKNOWN, floor: float = NOISE / 4, channel: str = "T") -> Selection:
    """A declared term of CARRIED rms, beside an effect of `size` rms that is chosen."""
    rest = NOISE * np.random.default_rng(6).standard_normal(ROWS)
    y = CARRIED * DECLARED[:, 0] + size * SHAPE[:, 0] + rest
    p = replace(problem(y, base=DECLARED), floor=floor, channel=channel)
    one = fit_with(p, p.base, term(name, SHAPE))
    assert one is not None
    return Selection.of(p).keep([one])


@pytest.mark.parametrize(("part", "stays"), [(0.04, False), (0.06, True)])
def test_an_unnamed_function_is_a_twentieth_of_what_the_declared_terms_carry(
    part: float, stays: bool
) -> None:
    left = leave_out(chosen(part * CARRIED), within_own_errors)
    assert bool(left.chosen) is stays
    if not stays:
        assert [r.why for r in left.refused] == ["less than 5 % of what the declared terms carry"]


@pytest.mark.parametrize(
    "more",
    [
        {"name": "brake_drag"},  # its form is its own
        {"floor": 0.6 * NOISE},  # the floor is nearly reached: no error of that size is left
        {"floor": 0.0},  # nobody knows what is left above it
        {"channel": "K"},  # two sensors agree to a millionth of what they see
    ],
)
def test_what_has_a_name_or_reaches_the_floor_stays_however_small(more: dict[str, object]) -> None:
    assert len(leave_out(chosen(0.02 * CARRIED, **more), within_own_errors).chosen) == 1  # type: ignore[arg-type]
