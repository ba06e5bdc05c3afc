"""A table's clock: rows out of order, parts that start again, and one that goes back is refused."""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from calibration.errors import CalibrationInputError
from calibration.inputs.clock import check_clock, in_order, parts_of_clock, parts_of_label


def parts(*t: float, **columns: np.ndarray) -> list[tuple[list[float], int]]:
    clock = np.array(t, dtype=float)
    return [(raw["t"].tolist(), left) for raw, left in parts_of_clock({"t": clock, **columns}, clock)]


NAN = float("nan")
EVEN = [float(k) for k in range(200)]


@pytest.mark.parametrize(
    ("t", "edges"),
    [
        ([0, 1, 2, 0, 1, 2], [3]),
        ([0, 1, 2, 3, 1, 2], [4]),
        ([5, 6, 7, 8, 9, 8, 9, 10], [5]),  # three steps from the first stamp
        ([5, 6, 7, 8, 9, 10, 9, 10], []),  # four
        ([5, 6, 7, 8, 9, 2, 3, 4], [5]),
        ([5, 6, 7, 8, 9, 1, 2, 3], []),
        ([-5, -4, -3, -2, -5, -4, -3], [4]),
        ([0, 1, 1, 2], []),  # a stamp that stays does not go back
        ([0, 1, 2, 0, 1, 0, 1], [3, 5]),
        ([0, 1, 2, 0, 1, 9, 8], []),  # one start and one that is none
        ([0, 0, 0], []),
        ([0, 1, 2], []),
        ([0], []),
    ],
)
def test_a_part_begins_where_the_clock_starts_again(t: list[float], edges: list[int]) -> None:
    ends = [0, *edges, len(t)]
    told = [([float(x) for x in t[a:b]], 0) for a, b in pairwise(ends)]
    assert parts(*t) == told


def test_a_row_of_nothing_is_left_out_and_one_without_a_stamp_is_told() -> None:
    """The first row, and rows that were never written behind the last one."""
    assert parts(NAN, *EVEN, 0.0, 0.0, 0.0) == [(EVEN, 1)]
    assert parts(NAN, 0.0, NAN, 1.0) == [([0.0, 1.0], 2)]
    ((kept, left),) = parts(NAN, 0.0, 1.0, 2.0, x=np.ones(4))
    assert len(kept) == 4 and left == 0
    assert len(parts(NAN, NAN)[0][0]) == 2


def test_a_part_whose_clock_stands_was_never_written() -> None:
    assert parts(0, 1, 2, 3, 0, 0, 0) == [([0, 1, 2, 3], 0)]
    assert parts(0, 1, 2, 0, 1, 0, 0) == [([0, 1, 2], 0), ([0, 1], 0)]


@pytest.mark.parametrize(
    ("label", "sizes"),
    [
        ([1, 1, 2, 2, 2, 1], [2, 3, 1]),
        ([5, 5, 5], [3]),
        ([7], [1]),
        ([NAN, 1, NAN, 1, NAN, 2, NAN], [5, 2]),  # a row without one belongs to the run before
        ([NAN, NAN], [2]),
    ],
)
def test_a_label_parts_every_column(label: list[float], sizes: list[int]) -> None:
    x = np.arange(len(label), dtype=float)
    found = parts_of_label({"x": x, "label": np.array(label)}, np.array(label), None)
    assert [len(part["x"]) for part in found] == sizes
    even = parts_of_label({"x": x}, np.array(label), x)
    assert [len(part["x"]) for part in even] == sizes
    assert np.concatenate([part["x"] for part in found]).tolist() == x.tolist()


def test_a_long_gap_of_the_clock_leaves_the_sensors_their_zeros() -> None:
    label, x = np.repeat([1.0, 2.0, 3.0], 20), np.arange(60.0)
    for gap, sizes in ((100, [20, 20, 20]), (101, [20, 40])):
        t = np.cumsum(np.where(x == 40, gap, 1.0))
        assert [len(part["x"]) for part in parts_of_label({"x": x}, label, t)] == sizes


def test_rows_out_of_order_are_left_out_of_every_column() -> None:
    t = [*EVEN[:50], 3.0, *EVEN[50:]]
    x = np.arange(201.0)
    ((raw, left),) = parts_of_clock({"t": np.array(t), "x": x}, np.array(t))
    assert raw["t"].tolist() == EVEN and left == 1
    assert raw["x"].tolist() == np.delete(x, 50).tolist()


@pytest.mark.parametrize(
    ("stray", "kept"),
    [
        ({50: 3.0, 90: 3.0}, {50, 90}),  # a hundredth of two hundred rows
        ({50: 3.0, 90: 3.0, 120: 3.0}, set()),
        ({50: 500.0}, {50}),
        ({0: 500.0}, {0}),
        ({199: 3.0}, {199}),
        ({50: np.nan, 90: 3.0}, set()),  # not all are numbers
        ({50: 49.0}, set()),  # twice the same stamp is in order
        ({**dict.fromkeys(range(11, 20), 10.0), 50: 3.0}, {50}),  # ten times is, too
        ({}, set()),
    ],
)
def test_the_longest_part_that_never_goes_back_is_kept(stray: dict[int, float], kept: set[int]) -> None:
    t = np.array(EVEN)
    t[list(stray)] = list(stray.values())
    assert set(range(200)) - set(in_order(t).tolist()) == kept


def test_a_run_of_rows_ahead_costs_more_rows_than_it_goes_back() -> None:
    t = np.array(EVEN)
    t[50:53] += 1000.0  # three rows, and back once
    assert in_order(t).tolist() == list(range(200))


@pytest.mark.slow
@settings(max_examples=50, deadline=None)
@given(st.lists(st.floats(-10, 10), min_size=150, max_size=160), st.integers(0, 149), st.floats(-99, 99))
def test_what_is_kept_never_goes_back_and_is_no_shorter_than_without_the_stray(
    stamps: list[float], at: int, stray: float
) -> None:
    t = np.sort(np.array(stamps))
    t[at] = stray
    kept = in_order(t)
    assert np.all(np.diff(t[kept]) >= 0) and len(kept) >= len(t) - 1


def refused(*t: float) -> str:
    with pytest.raises(CalibrationInputError) as caught:
        check_clock(Path("a.csv"), np.array(t), "time")
    return str(caught.value)


def test_a_clock_goes_forward() -> None:
    for sound in ([0.0], [], [0.0, 1.0, 1.0, 2.0, 3.0]):
        check_clock(Path("a.csv"), np.array(sound), "time")
    assert refused(0, 0) == refused(2, 1) == refused(0, 0, 0, 5) == "a.csv: column 'time': does not advance"
    assert refused(0, 1, 2, 1.5, 3, 2) == "a.csv:4: column 'time': time goes backwards from 2 to 1.5"
