"""Limits of a stretch that is left out, in small residuals that are whole numbers; what is told of it."""

from dataclasses import replace
from functools import partial
from types import SimpleNamespace as Some
from typing import Any

import numpy as np
import pytest

from calibration.balances.filters import Filter
from calibration.balances.problem import Problem
from calibration.decide.selection import Selection
from calibration.finding import Finding
from calibration.look import event
from tests.calibration.look.test_steps_and_events import problem
from tests.calibration.names.made import PERIOD_S, drive

ROWS, FITTED = 1500, 1200
PLAIN = np.zeros((ROWS, 1))  # takes nothing: the residual is y
HALF = np.repeat([0, 1], ROWS // 2)


def steps(*each: tuple[int, int, float], usual: float = 0.0, **more: Any) -> Problem:
    """Rows from one to another of a size; a last fifth is held out, pieces dilate by twenty rows."""
    y = np.full(ROWS, usual)
    for first, last, size in each:
        y[first:last] = size
    return problem(y, **{"held": np.arange(ROWS) >= FITTED, **more})


@pytest.mark.parametrize(
    ("p", "least", "rows"),
    [
        (steps((398, 400, 10.0), (400, 405, 100.0)), 0, range(400, 405)),  # a tenth of the largest is slope
        (steps((398, 400, 11.0), (400, 405, 100.0)), 0, range(398, 405)),
        (steps((400, 430, 110.0), usual=10.0), 0, ()),  # eight deviations, 119, are not reached
        (steps((400, 430, 120.0), usual=10.0), 0, range(400, 430)),
        (steps((400, 405, 100.0), (460, 465, 20.0)), 0, range(400, 405)),  # the larger of two
        (steps((400, 405, 20.0), (460, 465, 100.0)), 0, range(460, 465)),
        (steps((400, 405, 100.0), (430, 435, 20.0)), 0, range(400, 435)),  # nearer than twice a block: one
        (steps((400, 405, 100.0), (500, 1000, 10.0)), 0, ()),  # just half of the square
        (steps((400, 405, 100.0), (500, 999, 10.0)), 0, range(400, 405)),
        (steps((400, 405, 100.0)), 100.0, ()),
        (steps((400, 405, 100.0)), 99.9, range(400, 405)),
        (steps((400, 520, 100.0)), 0, ()),  # a tenth of the fitted rows
        (steps((400, 519, 100.0)), 0, range(400, 519)),
        (steps((400, 405, 1e-3)), 0, range(400, 405)),
        (steps((1195, 1205, 1e-3), (1300, 1310, 5.0)), 0, range(1195, 1205)),  # a larger one is held
    ],
)  # fmt: skip
def test_a_stretch_is_short_far_off_and_holds_most(p: Problem, least: float, rows: Any) -> None:
    assert np.flatnonzero(event._stretches(p, PLAIN, least)).tolist() == list(rows)


def test_rows_that_are_not_valid_are_in_no_stretch() -> None:
    p = steps((390, 400, 1e-3), (400, 405, 1e-3))
    p.valid[390:400] = False
    assert np.flatnonzero(event._stretches(p, PLAIN, 0.0)).tolist() == list(range(400, 405))


def test_each_file_has_a_stretch_where_it_holds_most_of_the_file() -> None:
    """One file's holds just half of its square; of all files' together one may hold just half, too."""
    half = steps((100, 105, 100.0), (130, 630, 10.0), (1000, 1005, 900.0), session=HALF)
    assert np.flatnonzero(event._stretches(half, PLAIN, 0.0)).tolist() == list(range(1000, 1005))
    two = steps((100, 105, 100.0), (1000, 1005, 900.0), session=HALF)
    found = np.flatnonzero(event._stretches(two, PLAIN, 0.0)).tolist()
    assert found == [*range(100, 105), *range(1000, 1005)]
    other = steps((100, 105, 100.0), (755, 1005, 10.0), (1010, 1110, -10.0), (1111, 1200, 10.0), session=HALF)
    other.y[600:661] = 10.0  # 250 + 100 + 89 + 61 rows of 10, none of which is far
    assert not event._stretches(other, PLAIN, 0.0).any()
    other.y[660] = 0.0
    assert np.flatnonzero(event._stretches(other, PLAIN, 0.0)).tolist() == list(range(100, 105))


def test_the_robust_fit_of_a_constant_is_the_median() -> None:
    y = np.array([0.0, 1.0, 2.0, 30.0, 100.0])
    assert event._robust(np.ones((5, 1)), y) == pytest.approx([2.0], abs=0.1)


def test_files_in_turn_are_seen_beside_the_others_coefficients() -> None:
    """Ten apart, though every file's mean is nothing beside an offset of all."""
    y = 10.0 * HALF + 0.001 * np.sin(np.arange(ROWS))
    p = problem(y, session=HALF, turned=np.ones(ROWS, dtype=bool), slow=True)
    none = np.zeros(ROWS, dtype=bool)
    assert event._usual(p, np.ones((ROWS, 1)), none, none) == pytest.approx((1.4826 * 10) ** 2, rel=1e-3)


N = 3000
T: np.ndarray = PERIOD_S * np.arange(N)
X: np.ndarray = np.sin(2 * np.pi * T / 5) + 0.4 * np.sin(2 * np.pi * T / 3.3)
PUSH_N = 4000.0


def _given(p: Problem, delay_s: float) -> Problem:
    assert delay_s == 0.0
    return p


def test_a_push_is_told_with_its_times_and_the_rows_about_it_are_left_out(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Of a force of noise beside an offset."""
    monkeypatch.setattr(event, "scene_of", lambda *_: Some(wander=np.zeros((N, 0))))
    y = 0.1 * np.random.default_rng(5).standard_normal(N)
    y[700:720] += PUSH_N
    s = drive(X, base=np.ones((N, 1)), y=y, held=np.arange(N) // 250 % 4 == 3, turn=9.0, columns={"force": y})
    s.problem.ar_order = 0
    f = event.leave_out_event(s.view, partial(_given, s.problem), Selection.of(s.problem))
    assert f is not None and f.note == "from 7 to 7.19 s of file 1 only: these rows are left out"
    assert (f.name, f.channel, f.domain) == ("unknown", "T", "time") and 0.99 < f.share < 1
    assert np.flatnonzero(~s.view.ok).tolist() == list(range(699, 721))


def told(
    monkeypatch: pytest.MonkeyPatch, p: Problem, after: float = 9.0, *, floor: float | None = 1.0,
    square: float = 0.0, every: float = 4.0, rest: float = 2.0, known: float | None = None, **view: Any,
) -> tuple[Finding | None, list[int]]:  # fmt: skip
    """The event of residuals that are y, and rows that are left out; usual squares are given."""
    v = drive(np.arange(float(ROWS)), files=p.session, **view).view
    if known is not None:
        v.rig = replace(v.rig, constants={"coulomb": known})
    monkeypatch.setattr(event, "floor_of", lambda *_: (floor, ""))
    monkeypatch.setattr(event, "scene_of", lambda *_: Some(wander=PLAIN))
    monkeypatch.setattr(event, "_usual", lambda p, x, event, out: rest if out.any() else every)
    s: Any = Some(held=Some(after=after), fitted_square=square)
    found = event.leave_out_event(v, partial(_given, replace(p, base=PLAIN)), s)
    return found, np.flatnonzero(~v.ok).tolist()


ONE = steps((400, 405, 100.0))


@pytest.mark.parametrize(
    ("p", "given", "event_there"),
    [
        (ONE, {}, True),
        (ONE, {"after": 2.0}, False),  # two floors are all that is left
        (ONE, {"after": 2.0, "floor": 0.99}, True),
        (ONE, {"after": 2.0, "square": 4.1}, True),
        (ONE, {"after": 1.5, "floor": None}, True),
        (steps((400, 405, 1.5)), {"after": 1.5, "floor": None}, True),
        (ONE, {"floor": 49.0, "after": 99.0}, True),  # a push of two floors at least
        (ONE, {"floor": 50.0, "after": 101.0}, False),
        (ONE, {"known": 50.0}, False),  # what turns leaves twice its friction
        (ONE, {"known": 49.0}, True),
        (ONE, {"rest": 3.0}, False),  # a quarter off the usual square
        (ONE, {"rest": 2.99}, True),
        (replace(ONE, held=ONE.held & False), {}, False),
        (replace(ONE, held=ONE.held | True), {}, False),
        (steps(), {}, False),
    ],
)  # fmt: skip
def test_an_event_is_above_floor_and_friction_and_pays(
    monkeypatch: pytest.MonkeyPatch, p: Problem, given: dict[str, Any], event_there: bool
) -> None:
    f, rows = told(monkeypatch, p, **given)
    assert (f is not None) == event_there == bool(rows)
    if f is not None:
        assert f.share == pytest.approx(1 - given.get("rest", 2.0) / 4.0)


def test_rows_within_three_deviations_of_the_filter_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    assert told(monkeypatch, ONE, filter=Filter(2.5))[1] == list(range(400 - 8, 405 + 8))
    first = steps((2, 7, 100.0))
    assert told(monkeypatch, first, filter=Filter(2.5))[1] == list(range(15))
    two = steps((400, 405, 100.0), (850, 855, 100.0), session=HALF)
    f, rows = told(monkeypatch, two)
    assert f is not None and rows == [*range(399, 406), *range(849, 856)]
    assert f.note == "from 4 to 4.04 s of file 1, 1 to 1.04 s of file 2 only: these rows are left out"


def test_friction_of_the_declared_terms_is_the_fitted_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a residual that is y less 30 of friction: a push of 59 is what a turn leaves, one of 61 is none."""
    way = np.where(np.arange(ROWS) // 50 % 2 == 0, 1.0, -1.0)
    monkeypatch.setattr(event, "floor_of", lambda *_: (1.0, ""))
    monkeypatch.setattr(event, "scene_of", lambda *_: Some(wander=PLAIN))
    monkeypatch.setattr(event, "_usual", lambda p, x, event, out: 1.0 if out.any() else 4.0)
    for size, there in ((59.0, False), (62.0, True)):
        p = replace(steps((400, 404, size), base_labels=[("coulomb", "N")]), base=way[:, None])
        p.y = p.y * np.resize([1.0, -1.0], ROWS) + 30.0 * way
        s: Any = Some(held=Some(after=9.0), fitted_square=0.0)
        v = drive(np.arange(float(ROWS))).view
        assert (event.leave_out_event(v, partial(_given, p), s) is not None) == there
