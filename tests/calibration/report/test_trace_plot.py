"""The held-out residual over its spans, and the gate: what is drawn where, and what is said beside it."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from calibration.balances.problem import Problem
from calibration.decide.selection import Selection
from calibration.report.plots import BLUE, GREEN, GREY, RED, gate_plot, trace_plot
from tests.calibration.report.drawn import PERIOD_S, effect, fit, legend, problem, scores, selection


def drawn(figures: list[Any], s: Selection, declared: Selection | None = None) -> Any:
    trace_plot(s, declared or s, "A title")
    return figures[-1].axes[0]


def steps(*widths: float) -> np.ndarray:
    return np.concatenate([[0.0], np.cumsum(widths)])


def test_before_is_the_measured_column_and_after_is_without_the_effects(figures: list[Any]) -> None:
    y = np.arange(10.0)
    p = problem(y, held=4)
    s = selection(p, effect(np.ones(10)))
    ax = drawn(figures, s)
    before, after = ax.lines
    assert before.get_ydata().tolist() == [6.0, 7.0, 8.0, 9.0] and after.get_ydata().tolist() == [
        4.0,
        5.0,
        6.0,
        7.0,
    ]
    assert before.get_xdata() == pytest.approx(PERIOD_S * np.arange(4))
    assert legend(ax) == ["before, rms 7.58 N m", "after, rms 5.61 N m"]  # of 36, 49, 64, 81; 16, 25, 36, 49
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("time in the held-out span, s", "residual, N m")
    assert (before.get_color(), after.get_color()) == (GREY, BLUE) and ax.get_title(loc="left") == "A title"
    whole = drawn(figures, selection(problem(y), effect(np.ones(10)))).lines
    assert whole[0].get_ydata().tolist() == y.tolist() and whole[1].get_ydata().tolist() == (y - 2).tolist()


def test_before_is_of_the_declared_model_where_it_was_held_against_the_same_rows(figures: list[Any]) -> None:
    p, other = problem(np.arange(10.0), held=4), problem(np.ones(10), held=4)
    s = selection(p, effect(np.ones(10)))
    assert drawn(figures, s, selection(other)).lines[0].get_ydata().tolist() == [1.0] * 4
    fewer = selection(replace(other, held=np.arange(10) > 6))
    assert drawn(figures, s, fewer).lines[0].get_ydata().tolist() == [6.0, 7.0, 8.0, 9.0]


@pytest.mark.parametrize(("held", "told"), [(2, True), (3, False)])
def test_two_rows_are_no_trace(figures: list[Any], held: int, told: bool) -> None:
    ax = drawn(figures, selection(problem(np.arange(10.0), held=held)))
    assert [t.get_text() for t in ax.texts] == ["no held-out rows in this channel"] * told


def gappy(t: np.ndarray, **more: Any) -> Problem:
    return problem(np.arange(float(len(t))), t=t, period_s=1.0, **more)


@pytest.mark.parametrize(
    ("t", "run", "gaps"),
    [
        (steps(1, 1, 5, 1, 1), None, []),  # five periods are no gap
        (steps(1, 1, 5.1, 1, 1), None, [2]),
        (steps(1, 1, -9, 1, 1), None, [2]),
        (steps(1, 1, 0, 1, 1), None, []),
        (steps(1, 1, 1, 1, 1), [0, 0, 1, 1, 1, 1], [1]),
        (steps(1, 8, 1, 8, 1), None, [1, 3]),
    ],
)
def test_gaps_are_closed_but_for_a_little_and_marked(
    figures: list[Any], t: np.ndarray, run: list[int] | None, gaps: list[int]
) -> None:
    more = {} if run is None else {"run": np.array(run)}
    ax = drawn(figures, selection(gappy(t, **more)))
    widths = np.diff(t)
    whole = float(np.delete(widths, gaps).sum())
    widths[gaps] = min(0.02, 0.1 / max(len(gaps), 1)) * whole
    line, places = ax.lines[0], steps(*widths)
    ends = [k + 1 for k in gaps]
    assert line.get_xdata() == pytest.approx(np.insert(places, ends, np.nan), nan_ok=True)
    assert np.flatnonzero(np.isnan(line.get_ydata())).tolist() == [k + j for j, k in enumerate(ends)]
    marks = [float(m.get_xdata()[0]) for m in ax.lines[2:]]
    assert marks == pytest.approx([(places[k] + places[k + 1]) / 2 for k in gaps])
    scale = " (rows left out are not drawn to scale)"
    assert ax.get_xlabel() == f"time in the held-out span{'s' if gaps else ''}, s{scale if gaps else ''}"


@pytest.mark.parametrize(("count", "marks"), [(12, 12), (13, 0)])
def test_many_gaps_are_narrower_and_more_than_twelve_not_marked(
    figures: list[Any], count: int, marks: int
) -> None:
    t = steps(*np.tile([1.0, 9.0], count), 1.0)
    ax = drawn(figures, selection(gappy(t)))
    assert len(ax.lines) == 2 + marks
    x = ax.lines[0].get_xdata()
    assert np.nanmax(x) == pytest.approx(1.1 * (count + 1))  # a tenth of it is gaps


def gate(figures: list[Any], value: list[float], threshold: float, surrogates: list[float]) -> Any:
    s = selection(problem(np.zeros(4)), before=fit(np.zeros(4)), scores=scores(value, threshold, surrogates))
    gate_plot(s, "A title")
    return figures[-1].axes[0]


@pytest.mark.parametrize(
    ("value", "threshold", "surrogates", "at", "right", "said"),
    [
        ([3.0, 7.5], 4.0, [1.0, 2.0, 5.0], 7.5, 10.2, "this log, 7.5"),
        ([10.0], 4.0, [1.0], 10.0, 10.2, "this log, 10"),
        ([10.1], 4.0, [1.0], 10.0, 10.2, "this log, 10.1 (off scale)"),
        ([3.0], 1.0, [10.0, 2.0], 3.0, 12.24, "this log, 3"),
        ([], 0.0, [], 0.0, 1.0, "this log, 0"),
    ],
)
def test_the_log_stands_among_its_surrogates(
    figures: list[Any],
    value: list[float],
    threshold: float,
    surrogates: list[float],
    at: float,
    right: float,
    said: str,
) -> None:
    ax = gate(figures, value, threshold, surrogates)
    green, red = ax.lines
    assert (green.get_xdata()[0], green.get_color()) == (threshold, GREEN)
    assert (red.get_xdata()[0], red.get_color()) == (pytest.approx(at), RED)
    count = f"{len(surrogates)} surrogates of the residual"
    assert sorted(legend(ax)) == sorted([f"99 % threshold, {threshold:.2f}", said, count])
    assert ax.get_xlim() == pytest.approx((0.0, right))
    heights = [bar.get_height() for bar in ax.patches]
    assert len(heights) == 30 and sum(heights) == len(surrogates)
    last = ax.patches[-1]
    end = max([*surrogates, threshold]) or 1.0
    assert ax.patches[0].get_x() == pytest.approx(0.0) and last.get_x() + last.get_width() == pytest.approx(
        end
    )
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("largest score, -log10 p", "surrogates")
