"""Figures of a campaign: shares and rank correlations against closed formulas, bars against runs."""

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from scenarios.campaign import figures
from scenarios.campaign.figures import Influence, distributions, influence, numbers, share
from scenarios.run.report.style import COLOURS

RUNS = {"metric: error": list(range(41))}
PAIRS = {"metric: error": [0] * 30 + [100] * 30}


def arrays(*rows: list[float]) -> list[Any]:
    return [np.array(row, dtype=float) for row in rows]


def hue(colour: Any) -> str:
    from matplotlib.colors import to_hex

    return to_hex(colour)


def reds(view: Any) -> list[int]:
    """Bars that are red."""
    return [k for k, bar in enumerate(view.patches) if hue(bar.get_facecolor()) == COLOURS["bad"]]


def test_a_rank_correlation_and_its_interval_are_by_formula() -> None:
    """Spearman without ties: 1 - 6 sum d^2 / (n (n^2 - 1)); two neighbours have changed places."""
    x, y = arrays([1, 2, 3, 4, 5, 6, 7, 8], [10, 30, 20, 40, 50, 60, 70, 80])
    found = influence("input: a", x, "metric: b", y)
    r = 1 - 6 * 2 / (8 * 63)
    half = 1.959964 * math.sqrt((1 + r * r / 2) / 5)
    assert found is not None and found[:2] == ("input: a", "metric: b") and found.runs == 8
    expected = (r, math.tanh(math.atanh(r) - half), math.tanh(math.atanh(r) + half))
    assert found[2:5] == pytest.approx(expected)


def test_runs_in_the_same_order_leave_no_doubt() -> None:
    x, y = arrays(list(range(8)), [k**3 for k in range(8)])
    assert influence("a", x, "b", y) == Influence("a", "b", 1.0, 1.0, 1.0, 8)
    assert influence("a", x, "b", -y) == Influence("a", "b", -1.0, -1.0, -1.0, 8)


@pytest.mark.parametrize("beyond", [1.0000000000000002, -1.0000000000000002])
def test_a_correlation_that_is_rounded_beyond_one_is_one(
    beyond: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(figures, "spearmanr", lambda x, y: SimpleNamespace(statistic=beyond))
    (x,) = arrays(list(range(8)))
    found = influence("a", x, "b", x)
    assert found is not None and found.low == found.high == math.copysign(1.0, beyond)


def test_too_few_runs_or_none_that_change_tell_nothing() -> None:
    x, same = arrays(list(range(8)), [3] * 8)
    assert influence("a", x[:7], "b", x[:7]) is None
    assert influence("a", x, "b", same) is None and influence("a", same, "b", x) is None
    hole = x.copy()
    hole[3] = math.nan
    assert influence("a", hole, "b", x) is None and influence("a", x, "b", hole) is None


def test_runs_without_both_numbers_do_not_count() -> None:
    x, y = arrays(list(range(10)), list(range(10)))
    x[0], y[9] = math.inf, math.nan
    found = influence("a", x, "b", y)
    assert found is not None and found.runs == 8


def test_a_share_has_wilsons_interval() -> None:
    """Centre (p + z^2 / 2n) / (1 + z^2 / n); half width z sqrt(p (1 - p) / n + z^2 / 4n^2) by the same."""
    assert share(5, 10) == pytest.approx((0.5, 0.23659, 0.76341), abs=1e-5)
    assert share(0, 10) == pytest.approx((0.0, 0.0, 0.27753), abs=1e-5)
    value, low, high = share(0, 0)
    assert math.isnan(value) and (low, high) == (0.0, 1.0)


@settings(max_examples=20)
@given(st.integers(1, 50), st.data())
def test_a_share_lies_in_its_interval_and_mirrors(runs: int, data: st.DataObject) -> None:
    hits = data.draw(st.integers(0, runs))
    value, low, high = share(hits, runs)
    assert 0.0 <= low <= value + 1e-12 and value - 1e-12 <= high <= 1.0
    assert share(runs - hits, runs)[1] == pytest.approx(1.0 - high)


def test_a_column_is_numbers_or_nothing() -> None:
    found = numbers({"a": [1, 2.5, None, "3", True]}, "a")
    assert np.array_equal(found, [1.0, 2.5, math.nan, math.nan, 1.0], equal_nan=True)


def test_only_metrics_that_differ_are_drawn_nine_at_most(monkeypatch: pytest.MonkeyPatch) -> None:
    """Drawn by a stand-in, as nine panels take a second."""
    views: list[tuple[Any, ...]] = []

    def panel(_figure: object, *place: int, xlabel: str, ylabel: str) -> Any:
        views.append((*place, xlabel, ylabel))
        return SimpleNamespace(hist=lambda *_, **__: ([], [], []))

    titles: list[str] = []
    monkeypatch.setattr(figures, "axes", panel)
    monkeypatch.setattr(figures, "title", lambda _view, text: titles.append(text))
    columns: dict[str, list[Any]] = {f"metric: {k}": [0, k + 1] for k in range(10)}
    columns |= {"metric: same": [2, 2], "metric: none": [None, None], "metric: one": [3, None]}
    dull = ["metric: same", "metric: none", "metric: one"]
    assert distributions(columns, dull, {}, {}) is None
    assert distributions(columns, [*dull, *(f"metric: {k}" for k in range(10))], {}, {"1": "s"})
    assert titles == [str(k) for k in range(9)]
    labels = ["runs", "", ""] * 3
    assert views == [(3, 3, k + 1, "s" if k == 1 else "", labels[k]) for k in range(9)]


@pytest.mark.parametrize(("count", "rows"), [(3, 1), (4, 2)])
def test_three_panels_make_a_row(count: int, rows: int) -> None:
    columns: dict[str, list[Any]] = {f"{k}" * 60: [0, 1] for k in range(count)}
    figure: Any = distributions(columns, list(columns), {}, {})
    assert figure is not None
    assert figure.axes[-1].get_subplotspec().get_geometry() == (rows, 3, count - 1, count - 1)
    assert figure.axes[0].get_title(loc="left") == "0" * 44


@pytest.mark.parametrize(("limit", "upper", "red"), [
    (5, True, range(4, 30)), (5, False, range(3)), (-50, True, range(30)), (50, True, range(0)),
])  # fmt: skip
def test_bars_beyond_the_limit_are_red(limit: float, upper: bool, red: range) -> None:
    """Of 0..40 the bars go from 0.2 to 39.8, 1.32 each: the fourth holds the 5 alone, which passes."""
    figure: Any = distributions(RUNS, ["metric: error"], {"error": (limit, upper)}, {})
    assert figure is not None
    (view,) = figure.axes
    assert reds(view) == list(red)
    assert [bar.get_height() for bar in view.patches][3] == 1
    assert sum(bar.get_height() for bar in view.patches) == 41


def test_a_bar_without_runs_is_not_red() -> None:
    figure: Any = distributions(PAIRS, ["metric: error"], {"error": (50, True)}, {})
    assert figure is not None and reds(figure.axes[0]) == [29]
    figure = distributions(PAIRS, ["metric: error"], {"error": (50, False)}, {})
    assert figure is not None and reds(figure.axes[0]) == [0]


@pytest.mark.parametrize(("limit", "lines"), [(-100, 0), (-99, 1), (50, 1), (199, 1), (200, 0), (None, 0)])
def test_a_limit_is_drawn_where_it_is_near(limit: float | None, lines: int) -> None:
    """Within the bars' width beside them, 0..100 here."""
    limits = {} if limit is None else {"error": (limit, True)}
    figure: Any = distributions(PAIRS, ["metric: error"], limits, {})
    assert figure is not None
    assert [list(line.get_xdata()) for line in figure.axes[0].lines] == [[limit, limit]] * lines


def test_outliers_lie_in_the_last_bars() -> None:
    columns = {"metric: error": [-1e6, *range(1000), 1e6]}
    figure: Any = distributions(columns, ["metric: error"], {"error": (1e5, True)}, {})
    assert figure is not None
    bars = figure.axes[0].patches
    assert bars[0].get_x() == pytest.approx(0.005 * 1001 - 1) and len(bars) == 30
    assert bars[-1].get_x() + bars[-1].get_width() == pytest.approx(0.995 * 1001 - 1)
    assert sum(bar.get_height() for bar in bars) == 1002 and not reds(figure.axes[0])
