"""A log driven open loop in part: rows without a set point are the effort's, missing rows are held."""

import numpy as np

from calibration.replay.trace import _held


def test_a_set_point_is_held_through_missing_rows_and_not_through_an_open_loop() -> None:
    nan = np.nan
    present = np.array([True, True, False, False, True, True, False, True])
    x = np.array([nan, 5.0, nan, nan, 6.0, nan, nan, 7.0])
    assert np.array_equal(
        _held(x, present), [nan, 5.0, 5.0, 5.0, 6.0, nan, nan, 7.0], equal_nan=True
    )  # before, the open row had 6 and the axis was held there by a loop that was not closed
