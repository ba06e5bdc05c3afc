"""A law of the command that is another one below a rate: where it changes is read from the log."""

import numpy as np
import pytest

from calibration.balances.effortchange import FEW, LIMITS, likeliest_limit
from calibration.balances.problem import Problem

ROWS, GAINS = 20_000, np.array([3.0, 0.4, -2.5, 0.3])


def limit_of(rate: np.ndarray, below: np.ndarray, part: float) -> list[float]:
    """Of changes of the effort by GAINS, by `part` of them where `below`, in whole steps."""
    rng = np.random.default_rng(2)
    base = rng.normal(0.0, 3.0, (ROWS, 4))
    y = np.round(base @ GAINS * np.where(below, part, 1.0))
    t = 0.01 * np.arange(ROWS)
    run = np.repeat(np.arange(4), ROWS // 4)
    valid = np.ones(ROWS, dtype=bool)
    labels = [("gain", "1/3000 per count")] * 4
    zero = np.zeros(ROWS, dtype=np.int64)
    p = Problem(
        channel="S",
        unit="1/3000",
        y=y,
        base=base,
        base_labels=labels,
        t=t,
        run=run,
        session=zero,
        valid=valid,
        held=run == 3,
        period_s=0.01,
    )
    return likeliest_limit(p, rate)


@pytest.mark.parametrize("limit", [45.0, 388.0, 2000.0])
@pytest.mark.parametrize("part", [0.6, 1.3])
def test_the_limit_is_found_to_the_spacing_of_those_that_are_tried(limit: float, part: float) -> None:
    rate = np.random.default_rng(1).permutation(np.geomspace(5.0, 7200.0, ROWS))
    (found,) = limit_of(rate, rate < limit, part)
    assert abs(np.log(found / limit)) < np.log(LIMITS[1] / LIMITS[0])


def test_one_rate_has_no_limit() -> None:
    rate = np.full(ROWS, 15.0)
    rate[: int(FEW * ROWS / 2)] = 600.0
    assert limit_of(rate, rate < 100.0, 0.5) == []
