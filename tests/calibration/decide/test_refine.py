"""Nonlinear parameters on shapes that are made up: what columns take, where a search ends, onsets in gaps."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.candidate import Candidate
from calibration.balances.problem import Problem
from calibration.decide.refine import Rest, never_begins, polish, refine, settled, slopes, unseen
from calibration.statistics.whitening import Whitener
from tests.calibration.decide.made import PERIOD_S, problem, term

ROWS = 2000
T = PERIOD_S * np.arange(ROWS)
RNG = np.random.default_rng(81)
A, B, C, LUCK = RNG.standard_normal((4, ROWS))
PLAIN = Whitener(np.zeros(0))
Shape = Callable[[np.ndarray], np.ndarray]


def rest(y: np.ndarray, base: np.ndarray | None = None, through: Whitener = PLAIN) -> Rest:
    return Rest(T < 80.0, np.ones((ROWS, 1)) if base is None else base, y, through)


def squares(y: np.ndarray, x: np.ndarray) -> float:
    return float(np.sum((y - x @ np.linalg.lstsq(x, y, rcond=None)[0]) ** 2))


@pytest.mark.parametrize("size", [1e-3, 1.0, 1e3])
@pytest.mark.parametrize("through", [PLAIN, Whitener(np.array([0.5]))])
def test_columns_take_what_a_least_squares_beside_the_base_leaves_less(
    size: float, through: Whitener
) -> None:
    base, y = np.column_stack([np.ones(ROWS), A]), A + 0.5 * B + C
    r = rest(y, base, through)
    white, e = through.whiten(base, r.train), through.whiten(y, r.train)
    for columns in (B[:, None], np.column_stack([B, C]), np.column_stack([B, C, B + C])):
        x = size * columns + 3.0 * A[:, None]
        both = np.hstack([white, through.whiten(x, r.train)])
        assert r.taken(x) == pytest.approx(squares(e, white) - squares(e, both))


def test_columns_of_nothing_take_nothing() -> None:
    assert rest(A).taken(np.zeros((ROWS, 1))) == rest(A).taken(np.zeros((ROWS, 3))) == 0.0


def tried(shape: Shape, steps: tuple[float, ...], *at: float, **more: Any) -> Candidate:
    fixed = {f"p{k}": (value, "s") for k, value in enumerate(at)}
    return term("brake_drag", shape(np.array(at)), shape=shape, steps=steps, fixed=fixed, **more)


def pulses(p: np.ndarray) -> np.ndarray:
    """Of a width of 8 s each, about 20 and 50 s, whose places do not depend on each other."""
    return np.column_stack(
        [np.exp(-(((T - c - q) / 8.0) ** 2)) for c, q in zip((20.0, 50.0), p, strict=False)]
    )


@pytest.mark.parametrize(("first", "second"), [(2.3, -1.7), (-2.9, 0.4), (0.0, 2.9)])
def test_a_search_ends_within_a_ninth_of_the_grids_step(first: float, second: float) -> None:
    y = pulses(np.array([first, second])).sum(axis=1)
    c = tried(pulses, (1.0, 0.5), 0.0, 0.5 * second)
    found = refine(rest(y), c)
    assert found.point == pytest.approx([first, second], abs=1.0 / 9)
    assert found.columns == pytest.approx(pulses(found.point)) and c.point[0] == 0.0


def test_without_a_shape_there_is_nothing_to_search() -> None:
    plain = term("brake_drag", A[:, None])
    assert refine(rest(A), plain) is plain and polish(rest(A), plain) is plain
    assert slopes(plain, np.ones(1)).shape == (ROWS, 0)


def stepped(p: np.ndarray) -> np.ndarray:
    """A step that no row sees from 30 to 40 s, where none was logged."""
    return np.asarray((np.where((T > 30.0) & (T < 40.0), 40.0, T) > p[0]).astype(float))[:, None]


def test_of_places_that_take_as_much_an_open_parameter_has_the_middle_and_another_stays() -> None:
    y = stepped(np.array([35.0]))[:, 0] - 0.5
    gap = Rest((T < 30.0) | (T > 40.0), np.ones((ROWS, 1)), y, PLAIN)
    assert refine(gap, tried(stepped, (1.0,), 32.0)).point[0] == 32.0
    middle = refine(gap, tried(stepped, (3.0,), 32.0, open=True)).point[0]
    assert middle == pytest.approx(35.0, abs=1.0)
    # from outside, the first place that takes more
    reached = [refine(gap, tried(stepped, (2.0,), 27.0, open=x)).point[0] for x in (False, True)]
    assert 30.0 <= reached[0] <= 33.0 and reached[1] == pytest.approx(32.0, abs=1.0)


def ramps(p: np.ndarray) -> np.ndarray:
    return np.asarray(np.clip((T - p[0]) / max(float(p[1]), 1.0), 0.0, 1.0))[:, None]


def test_an_onset_and_a_ramp_that_depend_on_each_other_are_moved_together() -> None:
    y = ramps(np.array([30.0, 20.0]))[:, 0]
    c = tried(ramps, (2.0, 4.0), 34.0, 12.0)
    found = polish(rest(y - y.mean()), c)
    assert found.point == pytest.approx([30.0, 20.0], abs=0.3)
    assert found.columns == pytest.approx(ramps(found.point))
    best = tried(ramps, (2.0, 4.0), 30.0, 20.0)
    assert polish(rest(y - y.mean()), best).point == pytest.approx([30.0, 20.0], abs=1e-3)
    one = replace(c, steps=(2.0,), shape=lambda p: ramps(np.array([p[0], 12.0])))
    assert polish(rest(y - y.mean()), one) is one


@pytest.mark.parametrize("step", [0.1, 4.0])
def test_slopes_are_derivatives_of_what_the_coefficients_make(step: float) -> None:
    """Of a square the difference of both sides is exact."""

    def shape(p: np.ndarray) -> np.ndarray:
        return np.column_stack([p[0] ** 2 * A + p[1] * C, p[1] ** 2 * B])

    c = tried(shape, (step, step), 2.0, -3.0)
    found = slopes(c, np.array([5.0, 7.0]))
    assert found == pytest.approx(np.column_stack([5.0 * 4.0 * A, 5.0 * C - 7.0 * 6.0 * B]))


def logged(
    first: float, last: float, y: np.ndarray | None = None, base: np.ndarray | None = None, held: bool = False
) -> Problem:
    """Rows every 0.05 s but for those between; `held`: those between are held out instead."""
    p = problem(A if y is None else y, base)
    gap = (first < T) & (last > T)
    p.held = gap if held else np.zeros(ROWS, dtype=bool)
    p.valid = np.ones(ROWS, dtype=bool) if held else ~gap
    return p


def onset(start: float, duration: float | None = None, scale: float = 1.0) -> Candidate:
    at = {"start": (start, "s"), **({} if duration is None else {"duration": (duration, "s")})}

    def shape(p: np.ndarray) -> np.ndarray:
        length = float(p[1]) if len(p) > 1 else 0.0
        return scale * np.asarray(np.clip((T - p[0]) / max(length, 1e-6), 0.0, 1.0))[:, None]

    columns = shape(np.array([value for value, _ in at.values()]))
    return term("brake_drag", columns, shape=shape, steps=(1.0,) * len(at), fixed=at)


@pytest.mark.parametrize("scale", [1.0, 30.0])
@pytest.mark.parametrize(
    ("start", "duration"), [(30.1, None), (45.3, None), (59.9, None), (30.2, 4.0), (55.0, 4.0)]
)
def test_an_onset_in_a_gap_is_anywhere_in_it(start: float, duration: float | None, scale: float) -> None:
    found = unseen(logged(30.0, 60.0), onset(start, duration, scale))
    assert found is not None
    assert 30.0 <= found[0] <= 30.25 and 59.75 <= found[1] <= 60.0


@pytest.mark.parametrize(("width", "told"), [(1.5, False), (2.6, True), (5.3, True), (11.9, True)])
def test_a_gap_of_less_than_two_seconds_is_none(width: float, told: bool) -> None:
    found = unseen(logged(40.0, 40.0 + width), onset(40.0 + width / 2))
    assert (found is not None) is told
    if found is not None:
        assert 0.0 <= found[0] - 40.0 <= 0.25 and 0.0 <= 40.0 + width - found[1] <= 0.25


def test_a_change_that_rows_see_or_that_none_has_is_not_unseen() -> None:
    p = logged(30.0, 60.0)
    assert unseen(p, onset(20.0)) is None
    assert unseen(p, onset(25.0, 40.0)) is None  # a ramp through the gap
    assert unseen(p, onset(150.0)) is None  # beyond the log
    assert unseen(p, replace(onset(45.0), fixed={"time": (45.0, "s")})) is None
    assert unseen(p, replace(onset(45.0), steps=())) is None  # of a grid


def test_of_a_change_before_the_log_the_first_onset_is_far_away() -> None:
    found = unseen(logged(30.0, 60.0), onset(-5.0))
    assert found is not None and found[0] < -1e4 and -0.25 <= found[1] <= 0.0


@pytest.mark.parametrize(("off", "before"), [(0.005, True), (0.02, False)])
@pytest.mark.parametrize("scale", [0.1, 1.0, 10.0])
def test_a_change_that_is_as_had_it_come_long_before_is_none(off: float, before: bool, scale: float) -> None:
    """Alike: to a hundredth of the columns' rms."""
    wave = off * np.sqrt(2) * np.cos(T)

    def shape(p: np.ndarray) -> np.ndarray:
        return np.asarray(scale * (1.0 + wave * (p[0] > -1000.0)))[:, None]

    c = replace(onset(45.0), columns=shape(np.array([45.0])), shape=shape)
    p = logged(30.0, 60.0, base=C[:, None])
    assert never_begins(p, c).startswith("it came before the log begins") is before


def test_what_does_not_begin_never_does() -> None:
    p = logged(30.0, 60.0, base=C[:, None])
    assert never_begins(p, onset(45.0)) == "" and never_begins(p, term("cable_wrap", A[:, None])) == ""
    assert never_begins(p, onset(-5.0)).startswith("it came before the log begins")


@pytest.mark.parametrize(
    ("start", "own", "taken"),
    [(60.0, 0.07, True), (60.0, 0.13, False), (20.0, 0.02, True), (20.0, 0.03, False), (20.0, 0.07, False)],
)
@pytest.mark.parametrize("scale", [1e-3, 1.0])
def test_declared_terms_that_move_with_a_change_take_it(
    start: float, own: float, taken: bool, scale: float
) -> None:
    """A tenth of the change's mean square must be its own, or of what was before, a quarter as long here."""
    c = onset(start, scale=scale)
    x = c.columns[:, 0] / np.linalg.norm(c.columns)
    other = A - x * (A @ x)
    base = np.sqrt(1 - own) * x + np.sqrt(own) * other / np.linalg.norm(other)
    p = logged(99.0, 99.0, base=base[:, None])
    assert never_begins(p, c) == ("declared terms change with it, and take it as well" if taken else "")


@pytest.mark.parametrize("true", [34.0, 41.0, 52.0])
def test_of_onsets_in_a_held_out_stretch_the_one_that_leaves_least_is_taken(true: float) -> None:
    """Nine of them, ends included, over 30 s."""
    c = onset(45.0)
    p = logged(30.0, 60.0, 2.0 * onset(true).columns[:, 0] + 0.1 * LUCK, held=True)
    fit = p.fit(p.design([c]))
    moved = settled(p, p.base, c, fit)
    (at,) = moved.point
    assert abs(at - true) <= 30.0 / 8 / 2 + 0.25
    assert moved.columns == pytest.approx(onset(float(at)).columns)
    exact = onset(true)
    assert settled(p, p.base, exact, p.fit(p.design([exact]))).point == exact.point
    elsewhere = onset(20.0)
    assert settled(p, p.base, elsewhere, fit) is elsewhere
    none_held = logged(30.0, 60.0)
    assert settled(none_held, none_held.base, c, fit) is c


def test_what_lies_beyond_a_bound_does_not_draw_the_search() -> None:
    """A pulse of 2 at 18 s, beyond the bound, and one of 1 at 27 s within it."""

    def pulse(p: np.ndarray) -> np.ndarray:
        return np.exp(-(((T - p[0]) / 1.5) ** 2))[:, None]

    y = 2.0 * pulse(np.array([18.0]))[:, 0] + pulse(np.array([27.0]))[:, 0] + 1e-3 * LUCK
    c = tried(pulse, (2.0,), 22.0)
    assert refine(rest(y), c).point[0] == pytest.approx(18.0, abs=0.1)
    held = refine(rest(y), replace(c, within=(21.0, 30.0)))
    assert held.point[0] == pytest.approx(27.0, abs=2.0 / 9)
    assert held.columns == pytest.approx(pulse(held.point))
    edge = replace(c, within=(20.0, 24.0)).moved(np.array([18.0]))
    assert edge.point.tolist() == [20.0] and edge.columns == pytest.approx(pulse(np.array([20.0])))
