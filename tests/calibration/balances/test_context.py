"""Turning points, directions and the travel since a motion turned."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calibration.balances.context import direction_of, since_reversal, turning_points

ZIGZAG = np.array([0.0, 1.0, 3.0, 2.5, 3.5, 1.5, 0.0, 0.5, 0.0, 2.0])


def runs(*lengths: int) -> np.ndarray:
    return np.repeat(np.arange(len(lengths)), lengths)


def marks(angle: np.ndarray, run: np.ndarray, travel: float) -> list[int]:
    return np.flatnonzero(turning_points(angle, run, travel)).tolist()


def test_an_extreme_turns_where_more_than_the_travel_follows() -> None:
    """At 3.5, and at the last zero but one; going back by half a unit is no turn for a travel of one."""
    assert marks(ZIGZAG, runs(10), 1.0) == [4, 6]
    assert marks(ZIGZAG, runs(10), 0.4) == [2, 3, 4, 6, 7, 8]
    assert marks(ZIGZAG, runs(10), 0.5) == [4, 6]  # just the travel is none
    assert marks(ZIGZAG, runs(10), 10.0) == []
    assert marks(-ZIGZAG, runs(10), 1.0) == [4, 6]


def test_a_motion_has_a_heading_once_it_went_further_than_the_travel() -> None:
    assert marks(np.array([0.0, 1.0, 0.0]), runs(3), 1.0) == []
    assert marks(np.array([0.0, 1.1, 0.0]), runs(3), 1.0) == [1]
    assert marks(np.array([0.0, -1.1, 0.0]), runs(3), 1.0) == [1]


def test_small_moves_before_the_first_heading_have_their_extremes() -> None:
    """Up by one, down by two, up by three: either turn is followed by more than one."""
    assert marks(np.array([0.0, 1.0, -1.0, 2.0]), runs(4), 1.0) == [1, 2]
    assert marks(np.array([0.0, -0.5, 0.7]), runs(3), 1.0) == [1]
    assert marks(np.array([9.0, 0.0, -0.5, 0.7]), runs(1, 3), 1.0) == [1, 2]
    assert marks(np.array([0.0, 2.0, 0.0, 1.0, 0.0]), runs(5), 1.0) == [1]


def test_every_run_starts_anew() -> None:
    angle = np.array([0.0, 2.0, 4.0, 4.0, 6.0, 4.5, 3.0, 0.0])
    assert marks(angle, runs(8), 1.0) == [4]
    assert marks(angle, runs(3, 5), 1.0) == [3, 4]
    # without a heading of its own, the second run's first step back turns nothing
    assert marks(np.array([0.0, 2.0, 2.0, 0.0, -3.0]), runs(2, 3), 1.0) == [2]
    # what it counts from is its own first row, not the run's before
    assert marks(np.array([0.0, 5.0, 0.0, 0.9, 0.0]), runs(2, 3), 1.0) == [2]
    assert direction_of(angle, runs(3, 5), 1.0).tolist() == [1.0, 1.0, 1.0, 1.0, -1.0, -1.0, -1.0, -1.0]


def test_directions_are_those_of_the_way_to_the_next_turn() -> None:
    up, down = [1.0] * 4, [-1.0] * 2
    assert direction_of(ZIGZAG, runs(10), 1.0).tolist() == [*up, *down, 1.0, 1.0, 1.0, 1.0]
    assert not direction_of(ZIGZAG, runs(10), 4.0).any()
    assert not direction_of(np.array([0.0, 1.0]), runs(2), 1.0).any()  # no further than the travel
    assert direction_of(np.array([0.0, 1.1]), runs(2), 1.0).all()


def test_a_run_s_way_ends_in_its_own_last_row() -> None:
    angle = np.array([0.0, 1.0, 2.0, -9.0, -10.0, -11.0])
    assert direction_of(angle, runs(3, 3), 1.5).tolist() == [1.0] * 3 + [-1.0] * 3
    assert direction_of(angle + 50.0, runs(3, 3), 1.5).tolist() == [1.0] * 3 + [-1.0] * 3


def test_travel_is_counted_from_the_last_change_of_direction_or_run() -> None:
    angle = np.array([1.0, 2.0, 4.0, 3.0, 1.0, 0.0])
    way = np.array([1.0, 1.0, 1.0, -1.0, -1.0, -1.0])
    assert since_reversal(angle, way, runs(6)).tolist() == [0.0, 1.0, 3.0, 0.0, -2.0, -3.0]
    assert since_reversal(angle, way, runs(2, 4)).tolist() == [0.0, 1.0, 0.0, 0.0, -2.0, -3.0]
    assert since_reversal(angle, way, runs(4, 2)).tolist() == [0.0, 1.0, 3.0, 0.0, 0.0, -1.0]


@given(st.lists(st.integers(-20, 20), min_size=2, max_size=60), st.integers(1, 9))
def test_between_its_turns_a_motion_never_goes_back_further_than_the_travel(
    steps: list[int], travel: int
) -> None:
    steps = [0, 30, *steps]  # a first move that is one
    angle = np.cumsum(steps).astype(float)
    way = direction_of(angle, runs(len(steps)), float(travel))
    assert np.array_equal(direction_of(-angle, runs(len(steps)), float(travel)), -way)
    for label in (1.0, -1.0):
        for rows in np.split(np.arange(len(steps)), np.flatnonzero(np.diff(way)) + 1):
            if way[rows[0]] == label:
                part = label * angle[rows]
                assert (np.maximum.accumulate(part) - part).max() <= travel


@pytest.mark.parametrize("travel", [0.4, 1.0])
def test_a_turn_is_where_the_direction_changes(travel: float) -> None:
    way = direction_of(ZIGZAG, runs(10), travel)
    assert (np.flatnonzero(np.diff(way)) + 1).tolist() == marks(ZIGZAG, runs(10), travel)
