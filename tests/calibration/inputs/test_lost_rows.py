"""Rows that are missing or repeat the row before: how many it takes, and what tells them from the motion."""

import numpy as np
import pytest

from calibration.inputs.rows import lost_rows, rows_without_a_stamp
from calibration.inputs.run import Run
from tests.calibration.inputs.made import PERIOD_S, run, uneven_motion

PLACES = 10  # places that it takes


def gappy(rows: int, places: int, each: float = 2.0, moved: int | None = None) -> Run:
    """A steady drive; at `places` the stamps go on by `each` periods, and at `moved` of them "
    "the drive, too."""
    steps, travel = np.ones(rows - 1), np.ones(rows - 1)
    at = 5 + 15 * np.arange(places)
    steps[at] = each
    travel[at[: places if moved is None else moved]] = each
    t, x = (np.concatenate([[0.0], np.cumsum(part)]) for part in (steps, travel))
    return run(x, PERIOD_S * t)


@pytest.mark.parametrize(
    ("given", "missing"),
    [
        (gappy(300, PLACES), 10),
        (gappy(300, PLACES, 3.0), 20),
        (gappy(300, PLACES - 1, 3.0), 0),
        (gappy(201, PLACES), 10),
        (gappy(200, PLACES), 0),  # 199 steps
        (gappy(9_999, PLACES), 10),  # just more than one row in a thousand
        (gappy(10_000, PLACES), 0),
        (gappy(300, PLACES, 2.14), 10),  # within 0.15 of the beat
        (gappy(300, PLACES, moved=3), 10),
        (gappy(300, PLACES, moved=2), 0),  # moved 12 of 20: no more than a share of 0.6
    ],
)
def test_missing_rows_are_counted_where_the_drive_moved_on(given: Run, missing: int) -> None:
    lost_rows(given)
    assert [(x.kind, x.channel, x.rows, x.size, x.note) for x in given.repairs] == (
        [("lost", "all", missing, float(missing), f"{missing} rows are missing in 10 places")] * bool(missing)
    )


@pytest.mark.parametrize(("odd", "told"), [(3, 1), (4, 0)])
def test_a_clock_must_keep_the_beat_in_99_of_100_rows(odd: int, told: int) -> None:
    given = gappy(301, PLACES)
    steps = np.diff(given.columns["t"])
    steps[200 : 200 + odd] = 1.3 * PERIOD_S
    given.columns["t"] = np.concatenate([[0.0], np.cumsum(steps)])
    lost_rows(given)
    assert len(given.repairs) == told


def test_a_drive_at_rest_misses_rows_too() -> None:
    rest = gappy(300, PLACES)
    rest.columns["position"] = np.zeros(300)
    lost_rows(rest)
    assert len(rest.repairs) == 1


def test_how_far_the_drive_should_move_is_told_by_the_rows_just_beside() -> None:
    given = gappy(300, PLACES)
    travel = np.full(299, 10.0)
    for k in 5 + 15 * np.arange(PLACES):
        travel[k - 1 : k + 2] = 1.0, 2.0, 1.0
    given.columns["position"] = np.concatenate([[0.0], np.cumsum(travel)])
    lost_rows(given)
    assert given.repairs[0].rows == PLACES


def unstamped(
    rows: int, places: int, times: float = 2.0, first: int = 5, half: int = 0
) -> tuple[Run, np.ndarray]:
    """A drive that moves `times` as far at `places`, 1.5 times at `half` more; and where it did."""
    travel = uneven_motion(rows - 1)
    at = first + 15 * np.arange(places)
    travel[at] *= times
    travel[at[-1] + 15 + 12 * np.arange(half)] *= 1.5
    return run(np.concatenate([[0.0], np.cumsum(travel)])), at


@pytest.mark.parametrize(
    ("given", "each"),
    [
        (unstamped(300, PLACES), 1),
        (unstamped(300, PLACES, 3.0), 2),
        (unstamped(200, PLACES), 1),
        (unstamped(300, PLACES, half=2), 1),
        (unstamped(300, PLACES, first=2), 1),
        (unstamped(9_999, PLACES), 1),
    ],
)
def test_rows_are_put_later_by_those_missing_before_them(given: tuple[Run, np.ndarray], each: int) -> None:
    r, at = given
    true = PERIOD_S * np.arange(r.rows)
    for k in at:
        true[k + 1 :] += each * PERIOD_S
    rows_without_a_stamp(r)
    assert r.columns["t"] == pytest.approx(true)
    (found,) = r.repairs
    said = f"{10 * each} rows are missing in 10 places, though the stamps go on: rows are put later"
    assert (found.kind, found.channel, found.rows, found.size, found.note) == (
        "lost", "all", 10 * each, 10.0 * each, said
    )  # fmt: skip


@pytest.mark.parametrize(
    "given",
    [
        unstamped(300, PLACES - 1, 3.0),
        unstamped(199, PLACES),
        unstamped(300, PLACES, half=3),  # more than a quarter of the places is no whole step
        unstamped(300, PLACES, first=0),
        unstamped(300, PLACES, first=1),  # of the first two steps nothing tells
        unstamped(300, PLACES, times=1.0),
        unstamped(10_000, PLACES),
    ],
)
def test_rows_stay_where_too_little_tells(given: tuple[Run, np.ndarray]) -> None:
    before = given[0].columns["t"].copy()
    rows_without_a_stamp(given[0])
    assert given[0].columns["t"].tolist() == before.tolist() and not given[0].repairs


@pytest.mark.parametrize(("steps", "told"), [(9.0, 1), (8.0, 0)])
def test_a_row_tells_itself_from_two_by_more_than_eight_steps_of_the_sensor(steps: float, told: int) -> None:
    travel = np.full(299, steps)
    travel[5 + 15 * np.arange(PLACES)] *= 2
    travel[-40:] = 1.0  # such a column shows its step
    r = run(np.concatenate([[0.0], np.cumsum(travel)]))
    rows_without_a_stamp(r)
    assert len(r.repairs) == told


def counted(travel: np.ndarray, steps: np.ndarray | None = None) -> int:
    """Rows that are missing by a drive's travel, and by the steps of its clock, periods."""
    r = run(np.concatenate([[0.0], np.cumsum(travel)]))
    if steps is not None:
        r.columns["t"] = np.concatenate([[0.0], np.cumsum(PERIOD_S * steps)])
    rows_without_a_stamp(r)
    return sum(x.rows for x in r.repairs)


PLAIN = 5 + 15 * np.arange(12)


@pytest.mark.parametrize(
    ("uneven", "count"),
    [({0: 1, 1: -1, 2: 2}, 0), ({0: 1, 1: -1}, 10), ({0: 2, 1: -2}, 10), ({0: 3, 1: -3}, 12), ({0: 0}, 11)],
)
def test_an_uneven_clock_within_two_rows_of_a_place_says_nothing_there(
    uneven: dict[int, int], count: int
) -> None:
    travel, steps = uneven_motion(399), np.ones(399)
    travel[PLAIN] *= 2
    steps[[PLAIN[k] + beside for k, beside in uneven.items()]] = 1.2
    assert counted(travel, steps) == count


def test_a_place_is_told_by_two_rows_on_either_side() -> None:
    travel = uneven_motion(399)
    travel[PLAIN] *= 2
    beside = travel.copy()
    beside[[298, 300, 302]] *= 2
    assert counted(beside) == 12 + 2  # the middle one has two rows that are twice as far
    turning = travel.copy()
    turning[296:305] = [8.0, 8.0, 8.0, 8.0, 20.0, 12.0, 12.0, 12.0, 12.0]
    assert counted(turning) == 12


@pytest.mark.parametrize(("last", "count"), [(398, 11), (397, 11), (396, 12)])
def test_of_the_last_two_steps_nothing_tells(last: int, count: int) -> None:
    travel = uneven_motion(399)
    travel[[*PLAIN[:11], last]] *= 2
    assert counted(travel) == count


def test_a_quarter_of_the_places_may_be_between_whole_rows() -> None:
    travel = uneven_motion(399)
    travel[PLAIN] *= 2
    travel[[250, 270, 290]] *= 1.5
    assert counted(travel) == 12
