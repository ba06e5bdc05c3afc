"""The grid and its record, with a kernel that only counts: every row once, in order, in chunks."""

import numpy as np
import pytest
from numpy.typing import NDArray

from plant import grid as grid_of
from plant.grid import Grid
from plant.kernels import layout as at

STEP_NS = 500_000
Rows = NDArray[np.float64]


@pytest.fixture
def steps(monkeypatch: pytest.MonkeyPatch) -> list[int]:
    """How many steps the kernel was asked for; it fills the ring of truth as the real one does."""
    asked: list[int] = []

    def advance(world: Rows, count: int) -> None:
        asked.append(count)
        for row, w in enumerate(world):
            for _ in range(count):
                w[at.STEP] += 1.0
                every = int(w[at.RECORD_EVERY])
                if every and int(w[at.STEP]) % every == 0:
                    place = at.TRUTH + (int(w[at.RECORDED]) % at.TRUTH_ROWS) * at.TRUTH_SIZE
                    w[place : place + at.TRUTH_SIZE] = np.arange(at.TRUTH_SIZE) + 100.0 * row
                    w[place] = w[at.STEP]
                    w[at.RECORDED] += 1.0

    monkeypatch.setattr(grid_of, "advance", advance)
    return asked


@pytest.fixture
def grid(steps: list[int]) -> Grid:
    assert not steps
    return Grid(np.zeros((2, at.WIDTH)), STEP_NS)


class Sink:
    def __init__(self) -> None:
        self.chunks: dict[str, list[Rows]] = {"ra": [], "dec": []}

    def __call__(self, axis: str, rows: Rows) -> None:
        self.chunks[axis].append(rows)

    def times(self, axis: str) -> list[int]:
        """Steps at which its rows were written."""
        return [int(t) for rows in self.chunks[axis] for t in rows[:, 0]]


def test_it_goes_to_the_last_point_up_to_a_time(grid: Grid, steps: list[int]) -> None:
    for t_ns, points in ((0, 0), (499_999, 0), (500_000, 1), (999_999, 1), (2_750_000, 5), (100, 5)):
        grid.advance(t_ns)
        assert grid.now_ns == points * STEP_NS and grid.next_ns == (points + 1) * STEP_NS
        assert grid.world[0, at.STEP] == points
    assert steps == [1, 4], "nothing is asked for in vain"


def test_the_view_is_the_world_as_one_row(grid: Grid) -> None:
    grid.world[1, 3] = 7.5
    assert grid.view[at.WIDTH + 3] == 7.5
    grid.view[2] = 1.5
    assert grid.world[0, 2] == 1.5


def test_a_row_of_each_axis_every_ten_milliseconds(grid: Grid) -> None:
    sink = Sink()
    grid.record(sink)
    grid.advance(95_000_000)
    assert not sink.chunks["ra"], "it is handed over in chunks"
    grid.flush()
    for axis, first in (("ra", 1.0), ("dec", 101.0)):
        (rows,) = sink.chunks[axis]
        assert rows[:, 0].tolist() == [20 * k for k in range(1, 10)]
        assert rows.shape[1] == at.TRUTH_SIZE == 11 and rows[4, 1] == first and rows[4, 10] == first + 9
        rows[:] = -1.0
    assert grid.world[0, at.TRUTH] == 20.0, "the array is the sink's own"
    grid.flush()
    assert len(sink.chunks["ra"]) == 1, "and nothing is handed over twice"


@pytest.mark.parametrize("every", [1, 3])
@pytest.mark.parametrize("stride", [1, 7, 250, 255, 256, 700, 3000])
def test_rows_arrive_once_and_in_order_whatever_the_stride(
    grid: Grid, steps: list[int], every: int, stride: int
) -> None:
    sink = Sink()
    grid.record(sink, every * STEP_NS)
    total = 1400
    for step in range(stride, total + stride, stride):
        grid.advance(min(step, total) * STEP_NS)
    grid.record(None)
    for axis in ("ra", "dec"):
        assert sink.times(axis) == list(range(every, total + 1, every))
        assert all(0 < len(rows) <= 256 for rows in sink.chunks[axis])
    assert sum(steps) == total


def test_a_chunk_is_handed_over_before_the_ring_is_full(grid: Grid, steps: list[int]) -> None:
    """It holds 256; a row stays free."""
    sink = Sink()
    grid.record(sink, 2 * STEP_NS)
    grid.advance(509 * STEP_NS)
    assert steps == [509] and not sink.chunks["ra"]
    grid.advance(510 * STEP_NS)
    assert [len(rows) for rows in sink.chunks["ra"]] == [255]
    grid.advance(1531 * STEP_NS)
    assert [len(rows) for rows in sink.chunks["ra"]] == [255] * 3
    assert steps == [509, 1, 510, 510, 1]


def test_a_record_begins_where_it_is_asked_for_and_ends(grid: Grid) -> None:
    grid.advance(40 * STEP_NS)
    first, second = Sink(), Sink()
    grid.record(first, 10 * STEP_NS)
    grid.advance(75 * STEP_NS)
    grid.record(second, 5 * STEP_NS)
    assert first.times("dec") == [50, 60, 70]
    grid.advance(90 * STEP_NS)
    grid.record(None)
    grid.advance(5000 * STEP_NS)
    grid.flush()
    assert first.times("dec") == [50, 60, 70] and second.times("dec") == [80, 85, 90]
    assert not grid.world[:, at.RECORD_EVERY].any()


def test_nothing_is_recorded_unless_it_is_asked_for(grid: Grid, steps: list[int]) -> None:
    grid.advance(10_000 * STEP_NS)
    grid.flush()
    assert steps == [10_000] and not grid.world[:, at.RECORDED].any()


@pytest.mark.parametrize("period_ns", [1, 499_999, 500_001, 750_000, 0])
def test_a_period_is_a_whole_number_of_steps(grid: Grid, period_ns: int) -> None:
    with pytest.raises(ValueError, match="a multiple of the grid step, 500000 ns"):
        grid.record(Sink(), period_ns)
    grid.record(None, period_ns)
    grid.record(Sink(), 500_000)
    assert grid.world[:, at.RECORD_EVERY].tolist() == [1.0, 1.0]
