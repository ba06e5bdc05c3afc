"""A cable bundle keeps its state while nobody logs, unless it may have moved there."""

import numpy as np

from calibration.names.cable_wrap import _memory


def test_rows_are_followed_within_a_session_and_into_one_that_begins_at_the_same_place() -> None:
    x = np.array([0.0, 1.0, 5.0, 5.0, 6.0, 9.0, 9.5])
    session = np.array([0, 0, 0, 1, 1, 2, 2])
    assert _memory(x, session, 0.1).tolist() == [0, 0, 0, 0, 0, 1, 1]
