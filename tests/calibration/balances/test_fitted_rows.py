"""The rows of a drive's log that are fitted, and those near ends, gaps and bad rows that are not used."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.balances.view import View, choose_rows, fade, view_of
from calibration.inputs.declaration import Column, Response, Rig, Stage
from calibration.inputs.run import Run
from tests.calibration.names.made import drive

FORCE, SENSOR = Response("force", "N"), Response("position2", "m")


def chosen(rows: int, sigma: float = 0.0, response: Response = FORCE, **more: Any) -> View:
    given: dict[str, Any] = {k: more.pop(k) for k in ("stages", "analyse_period_s") if k in more}
    v = drive(0.001 * np.arange(rows), filter=Filter(sigma), response=response, rig=given, **more).view
    choose_rows(v)
    return v


@pytest.mark.parametrize(
    ("rows", "sigma", "step"),
    [(900, 4.4, 4), (900, 0.0, 1), (24_000, 0.0, 1), (24_001, 0.0, 2), (60_000, 2.0, 3)],
)
def test_a_row_per_filter_width_and_no_more_than_can_be_fitted(rows: int, sigma: float, step: int) -> None:
    v = chosen(rows, sigma)
    assert np.array_equal(v.rows, np.arange(0, rows, step))
    assert v.sigma == (step / 2 if sigma == 0 and step > 1 else sigma)


def test_sensors_have_fewer_rows_and_many_harmonics_less() -> None:
    assert chosen(4000, response=SENSOR).step == 1 and chosen(4001, response=SENSOR).step == 2
    many = (Stage("a", 1e9, None, 24, None), Stage("b", 1e9, None, 24, None))
    assert chosen(12_000, stages=many[:1]).step == 1 and chosen(24_000, stages=many[:1]).step == 1
    assert chosen(12_000, stages=many).step == 1 and chosen(12_001, stages=many).step == 2


def test_the_quickest_declared_line_has_four_rows_a_period() -> None:
    """100 000 rows of 0.001 are 100 units; of 500 waves a unit at a tenth a row... four rows each at most."""
    waves = (Stage("a", 0.01, None, 1, None), Stage("b", 0.01, None, 2, None), Stage("c", None, 1.0, 9, None))
    assert chosen(100_000).step == 5
    assert chosen(100_000, stages=waves).step == int(np.ceil(100_000 / (100.0 * 200 * 4)))


def test_a_rig_file_may_say_the_period_of_the_analysis() -> None:
    v = chosen(60_000, analyse_period_s=0.01)
    assert v.step == 1 and v.sigma == 0.0
    assert chosen(900, 4.0, analyse_period_s=0.07).step == 7
    assert chosen(900, 4.0, analyse_period_s=0.001).step == 1


def test_near_ends_and_bad_rows_nothing_is_used() -> None:
    bad = np.ones(900, dtype=bool)
    bad[450] = False
    files = np.repeat([0, 1], [600, 300])
    v = chosen(900, 2.5, ok=bad.copy(), files=files)
    margin = 8 + 1  # three deviations, and a row of the second difference
    unused = np.flatnonzero(~v.ok).tolist()
    ends = [*range(margin), *range(600 - margin, 600 + margin), *range(900 - margin, 900)]
    assert unused == sorted({*ends, *range(450 - margin, 451 + margin)})
    still = chosen(900, 2.5, ok=bad.copy(), dynamic=False)
    assert np.flatnonzero(~still.ok).tolist() == [*range(8), 450, *range(892, 900)]


def with_gap(response: Response, missing: slice, standing: bool = False) -> View:
    """A sine over 10 s that stands still from 10 to 15 s, if it is to, without the rows `missing`."""
    t = 0.01 * np.arange(3000)
    x = np.sin(2 * np.pi * t / 10)
    x = np.where((t > 10) & (t < 15) & standing, 0.0, x)
    columns = {"t": t, "position": x, "force": x, "position2": x}
    columns = {k: np.delete(z, missing) for k, z in columns.items()}
    run = Run(name="a", path=Path("a"), session="a", columns=columns, period_s=0.01)
    names = {"position": Column("m")}
    given = Rig("made", Path("made.yaml"), names, (response,), (), estimate=("inertia",), smooth_s=0.4)
    return view_of([run], given, response)


def test_a_gap_longer_than_the_filter_ends_a_segment() -> None:
    """Eight rows of standard deviation: seven missing ones are filtered over, and eight are not."""
    long, short = with_gap(FORCE, slice(500, 508)), with_gap(FORCE, slice(500, 507))
    assert set(short.segment) == {1} and np.flatnonzero(np.diff(long.segment)).tolist() == [499, 507]
    assert not long.ok[500:508].any() and short.ok[400:600].all()
    assert short.sigma == pytest.approx(8.0) and np.array_equal(short.rows, np.arange(0, 3000, 8))


def test_sensors_are_compared_over_a_gap_in_which_nothing_moves() -> None:
    still, moving = (with_gap(SENSOR, slice(1100, 1300), standing) for standing in (True, False))
    assert set(still.segment) == {1} and len(set(moving.segment)) == 3
    assert not still.ok[1100:1300].any() and not moving.ok[1100:1300].any() and still.ok[1000:1100].all()
    assert still.sigma == 0.0 and np.array_equal(still.rows, np.arange(3000))


def test_a_direction_without_a_top_speed_is_the_speed_s_own() -> None:
    v = drive(np.zeros(50), speed=np.full(50, 0.3), ok=np.zeros(50, dtype=bool)).view
    fade(v, 0.1)
    assert v.direction == pytest.approx(np.tanh(0.3))


def test_a_view_is_of_no_wander_and_stands_nowhere_unless_told() -> None:
    v = drive(np.arange(5.0)).view
    assert (v.rates, v.slow, v.standstill, v.in_order, v.slow_offset) == (0.0, 0.0, 0.0, False, None)
