"""Edges of turning points, repeats, sections and motions: one value more changes the answer."""

from typing import Any

import numpy as np
import pytest

from calibration.balances import guide
from calibration.balances.candidate import Candidate
from calibration.balances.context import turning_points
from calibration.balances.repeats import stroke_scatter
from calibration.balances.view import STANDSTILLS, View
from tests.calibration.balances.test_candidates import problem
from tests.calibration.balances.test_frames import run
from tests.calibration.balances.test_guide_sections import section
from tests.calibration.names.made import back_and_forth, drive


def marks(*angle: float, first: int = 0) -> list[int]:
    label = (np.arange(len(angle)) >= first).astype(np.int64)
    return np.flatnonzero(turning_points(np.array(angle), label, 1.0)).tolist()


def test_a_first_extreme_turns_where_the_travel_follows() -> None:
    assert marks(0.0, 0.9, -0.3) == [1] and marks(0.0, -3.0, -2.4) == []
    assert marks(0.0, 2.0, 5.0, 5.5, 4.2, first=2) == [2, 3]


@pytest.mark.parametrize(("frames", "mean"), [(1, 4.0), (2, 4.5)])
def test_a_cell_has_the_mean_of_its_frames(frames: int, mean: float) -> None:
    """The second cell of 3 s lies around 8 s: it has the frame at 9 s, and may have that at 8 s."""
    log = section(12)
    gone = [2, 3] if frames == 1 else [2]
    log.columns = {name: np.delete(x, gone) for name, x in log.columns.items()}
    found = guide._on_grid(log, np.array([5.0, 8.0, 11.0, 14.0]), 3.0)
    assert found[1] == pytest.approx(mean if frames == 1 else 3.5)


def test_frames_as_long_as_cells_by_a_half_are_put_between_frames() -> None:
    """A cell of 1.5 frames averages nothing, one of 1.6 does."""
    log = section(20, 2.0, ra=np.arange(20.0) ** 2)
    grid: np.ndarray = 5.0 + 3.0 * np.arange(5)
    between = np.interp(grid, log.columns["t"], log.columns["ra"])
    assert guide._on_grid(log, grid, 3.0) == pytest.approx(between)
    wider: np.ndarray = 5.0 + 3.2 * np.arange(5)
    assert guide._on_grid(log, wider, 3.2)[1] == 2.5  # of the frames 2 and 4 s on


def test_the_floor_of_a_quick_worm_is_of_few_cells() -> None:
    """A quarter of a turn of 20 s: five cells of a second; of 8 s, three at least."""
    rng = np.random.default_rng(1)
    log = section(900, ra=rng.standard_normal(900))
    for quickest, side in ((20.0, 5), (8.0, 3)):
        p, _ = guide.guide_problem([log], [], quickest_s=quickest)
        y = np.where(p.valid, p.y, np.nan)
        assert p.period_s == pytest.approx(min(quickest / 20, 3.0)) or p.period_s == 1.0
        assert p.floor == pytest.approx(guide._air(y, p.run, max(round(side / p.period_s), 3)))


@pytest.mark.parametrize(("rows", "told"), [(10, False), (11, True)])
def test_a_stroke_has_more_than_ten_rows(rows: int, told: bool) -> None:
    x = back_and_forth(100, rows, 200.0)
    e = np.repeat(np.arange(100.0), rows)
    assert (stroke_scatter(drive(x).view, e) is not None) == told


def test_strokes_are_compared_the_same_way() -> None:
    """What differs between the ways is no scatter."""
    x = back_and_forth(8, 200, 200.0)
    e = np.where(np.arange(1600) // 200 % 2, 5.0, -5.0)
    assert stroke_scatter(drive(x).view, e) == 0.0


def test_directions_fade_below_thousandths_of_the_top_speed() -> None:
    assert STANDSTILLS == (0.0005, 0.001, 0.002, 0.005, 0.01, 0.02)


def test_fields_of_a_view_and_a_problem_that_nobody_gives() -> None:
    fields: Any = View.__dataclass_fields__
    for name in ("speed", "direction", "since"):
        assert len(fields[name].default_factory()) == 0
    p = problem()
    assert (p.floor, p.step, p.slow, p.untold, p.base_phases, p.turned) == (0.0, 0.0, False, 0.0, (), None)
    c = Candidate("play", "reversal", np.ones((3, 1)), ())
    assert (c.least, c.sign, c.searched, c.most) == (0.0, 0, 0, np.inf)


def test_rows_that_are_held_out_lose_what_is_fitted_there_anew() -> None:
    """Files' own constants are told by nobody else, and need not be."""
    fresh = np.repeat(np.eye(3), 20, axis=0)
    p = problem(base=np.column_stack([fresh, np.arange(60.0) % 20]), fresh=fresh, held=np.arange(60) >= 40)
    assert p.told().untold == 0.0
    alone = problem(base=np.column_stack([fresh, np.arange(60.0) % 20]), held=np.arange(60) >= 40)
    assert alone.told().untold == 1.0


def test_a_run_that_begins_late_is_put_behind_the_one_before() -> None:
    from calibration.balances.frame import build_frame

    late = run(100, t=3.0 + 0.01 * np.arange(100))
    f = build_frame([late, run(50)])
    assert f.t[[0, 99, 100]] == pytest.approx([0.0, 0.99, 1.09])


def test_a_step_between_rows_is_that_of_the_first_two() -> None:
    v = drive(np.arange(90.0)).view
    v.rows = np.array([4, 9])
    assert v.step == 5
