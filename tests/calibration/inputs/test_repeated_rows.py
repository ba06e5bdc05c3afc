"""Rows that repeat the row before while the drive moves: how many it takes, and of which columns."""

import numpy as np
import pytest

from calibration.inputs.rows import repeated_rows
from calibration.inputs.run import Run
from tests.calibration.inputs.made import rig, run, uneven_motion


def repeating(rows: int, at: np.ndarray, step: float = 0.0) -> Run:
    """A quick motion whose rows `at` repeat the row before, its effort too."""
    r = run(np.cumsum(uneven_motion(rows)), effort=np.cos(np.arange(rows) / 7.0))
    if step:
        there = step * np.arange(rows // 2)
        r.columns["position"] = np.concatenate([there, there[::-1] + 1.0])
    for c in ("position", "effort"):
        r.columns[c][at] = r.columns[c][at - 1]
    return r


@pytest.mark.parametrize(
    ("rows", "at", "step", "told"),
    [
        (200, np.array([20, 60, 90]), 0.0, True),
        (200, np.array([20, 60]), 0.0, False),
        (199, np.array([20, 60, 90]), 0.0, False),
        (200, 2 + 4 * np.arange(40), 0.0, True),  # a fifth of the rows
        (200, 2 + 4 * np.arange(41), 0.0, False),
        (200, np.array([20, 60, 90]), 4.0, True),  # four steps of the sensor per row
        (200, np.array([20, 60, 90]), 3.0, False),
    ],
)
def test_repeated_rows_are_left_out(rows: int, at: np.ndarray, step: float, told: bool) -> None:
    r = repeating(rows, at, step)
    repeated_rows(r, rig("time", "position", "effort", "voltage"))
    lost = at.tolist() if told else []
    for c in ("position", "effort"):
        assert np.flatnonzero(np.isnan(r.columns[c])).tolist() == lost, c
    note = f"{len(at)} rows repeat the row before while the drive moves: left out"
    assert [(x.kind, x.channel, x.rows, x.size, x.note) for x in r.repairs] == (
        [("repeat", "all", len(at), float(len(at)), note)] * told
    )


def test_rows_repeat_only_where_every_moving_column_does() -> None:
    at = np.array([20, 60, 90])
    for columns, told in ((("position", "effort", "reference"), 1), (("position", "reference"), 0)):
        r = repeating(300, at)
        r.columns["reference"] = np.arange(300.0)  # is computed: it does not come with the frame
        repeated_rows(r, rig("time", *columns))
        assert len(r.repairs) == told
    r = repeating(300, at)
    r.columns["velocity"] = np.arange(300.0)
    repeated_rows(r, rig("position", "effort", "velocity"))
    assert not r.repairs


def test_a_drive_that_stands_repeats_itself() -> None:
    r = repeating(300, np.arange(20, 24))  # rows 21 to 23 repeat, and so does the row after: no motion there
    repeated_rows(r, rig("position", "effort"))
    assert not r.repairs
    still = run(np.zeros(300), effort=np.zeros(300))
    repeated_rows(still, rig("position", "effort"))
    assert not still.repairs
    paused = np.cumsum(np.where(np.isin(np.arange(300), [130, 140, 150]), 0.0, uneven_motion(300)))
    r = run(paused, effort=np.zeros(300))
    repeated_rows(r, rig("position", "effort"))
    assert not r.repairs  # one row's motion in two rows


def test_a_slow_motion_without_steps_repeats_rows_too() -> None:
    r = repeating(300, np.array([20, 60, 90]))
    r.columns["position"] *= 0.1
    repeated_rows(r, rig("position", "effort"))
    assert len(r.repairs) == 1
