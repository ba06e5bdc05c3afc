"""Figures of a campaign whose rows are named: what moves what, and what fails."""

from typing import Any

import pytest

from scenarios.campaign.figures import Influence, failures, influences
from scenarios.run.report.style import COLOURS
from tests.scenarios.campaign.test_figures import hue


def moved(name: str, metric: str, value: float, low: float = -1.0, high: float = 1.0) -> Influence:
    return Influence(f"input: {name}", f"metric: {metric}", value, low, high, 20)


def rows(figure: Any) -> list[str]:
    """Names of the rows, from below."""
    return [each.get_text() for each in figure.axes[0].get_yticklabels()]


def test_rows_go_by_metric_the_strongest_above() -> None:
    found = [moved("a", "n", 0.2), moved("b", "m", -0.9), moved("a", "m", 0.5), moved("b", "n", -0.4)]
    figure: Any = influences(found, ["input: a", "input: b"])
    assert rows(figure) == ["n  ←  a", "n  ←  b", "m  ←  a", "m  ←  b"]
    assert influences([], ["input: a"]) is None


def test_of_many_the_eighteen_strongest_are_shown() -> None:
    names = [f"i{k:02}" for k in range(20)]
    found = [moved(name, "m" * 60, 0.01 * (-1) ** k * (k + 1)) for k, name in enumerate(names)]
    figure: Any = influences(found, [f"input: {name}" for name in names])
    assert figure is not None
    assert rows(figure) == [f"{'m' * 44}  ←  {name}" for name in names[2:]]
    assert list(figure.axes[0].get_yticks()) == list(range(18))
    assert figure.axes[0].get_xlim() == (-1.05, 1.05)


@pytest.mark.parametrize(("low", "high", "sure"), [
    (0.1, 0.5, True), (-0.5, -0.1, True), (-0.1, 0.5, False), (0.0, 0.5, False), (-0.5, 0.0, False),
])  # fmt: skip
def test_an_interval_that_holds_zero_is_pale(low: float, high: float, sure: bool) -> None:
    figure: Any = influences([moved("a", "m", 0.25, low, high)], ["input: z", "input: a"])
    assert figure is not None
    (view,) = figure.axes
    line, point, zero = view.lines
    assert (list(line.get_xdata()), list(line.get_ydata())) == ([low, high], [0, 0])
    assert (list(point.get_xdata()), list(point.get_ydata())) == ([0.25], [0])
    assert list(zero.get_xdata()) == [0.0, 0.0]
    assert line.get_alpha() == (1.0 if sure else 0.35)
    assert hue(line.get_color()) == hue(point.get_markeredgecolor()) == COLOURS["dec"]
    assert hue(point.get_markerfacecolor()) == (COLOURS["dec"] if sure else "#ffffff")
    assert view.get_title(loc="left") == "What moves what (filled: the interval does not hold zero)"


@pytest.mark.parametrize("count", [6, 7, 14])
def test_inputs_keep_their_colour_and_share_it_beyond_seven(count: int) -> None:
    names = [f"i{k:02}" for k in range(count)]
    figure: Any = influences([moved(name, "m", 0.5) for name in names], [f"input: {name}" for name in names])
    assert figure is not None
    colours = {hue(each.get_color()) for each in figure.axes[0].lines[:-1:2]}
    assert len(colours) == min(count, 7)


def test_failures_are_shares_by_group_the_commonest_above() -> None:
    """Three of four runs miss a, one of four b; of the group of two half miss it, and none."""
    columns: dict[str, list[Any]] = {"missed": ["a; b", "a", None, "a"]}
    figure: Any = failures(columns, {"all": [0, 1, 2, 3], "late": [2, 3]})
    assert figure is not None
    (view,) = figure.axes
    assert rows(figure) == ["b", "a"] and list(view.get_yticks()) == [0, 1]
    assert [bar.get_width() for bar in view.patches] == [0.25, 0.75, 0.0, 0.5]
    centres = [bar.get_y() + bar.get_height() / 2 for bar in view.patches]
    assert centres == pytest.approx([0.2, 1.2, -0.2, 0.8])
    assert [line.get_ydata()[0] for line in view.lines] == pytest.approx(centres)
    assert [line.get_ydata()[1] for line in view.lines] == pytest.approx(centres)
    # by Wilson, 1 of 4 and 1 of 2 are 4.6 to 69.9 % and 9.5 to 90.5 %
    assert list(view.lines[0].get_xdata()) == pytest.approx([0.0456, 0.6994], abs=1e-4)
    assert list(view.lines[3].get_xdata()) == pytest.approx([0.0945, 0.9055], abs=1e-4)
    assert [each.get_text() for each in figure.legends[0].get_texts()] == ["all", "late"]
    assert view.get_xlim() == (0.0, 1.0) and view.get_title(loc="left") == "What fails"
    tops = [bar.get_height() for bar in view.patches]
    assert all(0.25 < each < 0.4 for each in tops)  # two of them fill most of a row and leave a gap
    assert len({hue(bar.get_facecolor()) for bar in view.patches}) == 2


def test_one_group_needs_no_legend_and_no_failure_no_figure() -> None:
    assert failures({"missed": ["", None]}, {"all": [0, 1]}) is None
    figure: Any = failures({"missed": ["x" * 60, None]}, {"all": [0, 1]})
    assert figure is not None and not figure.legends
    assert rows(figure) == ["x" * 44]
    assert [bar.get_y() + bar.get_height() / 2 for bar in figure.axes[0].patches] == pytest.approx([0.0])


def test_the_twelve_commonest_failures_are_shown() -> None:
    missed = ["; ".join(f"e{k:02}" for k in range(first, 14)) for first in range(14)]
    figure: Any = failures({"missed": missed}, {"all": list(range(14))})
    assert figure is not None
    assert rows(figure) == [f"e{k:02}" for k in range(2, 14)]


def test_figures_grow_with_their_rows() -> None:
    few: Any = influences([moved("a", "m", 0.5)], ["input: a"])
    many: Any = influences([moved("a", f"m{k}", 0.5) for k in range(9)], ["input: a"])
    assert few is not None and many is not None
    assert 0.5 < few.get_figheight() < many.get_figheight() < 10.0


@pytest.mark.parametrize("count", [1, 3])
def test_a_group_is_in_the_legend_once(count: int) -> None:
    """Whatever number of expectations it misses; both figures are one plot."""
    missed = "; ".join(f"e{k}" for k in range(count))
    figure: Any = failures({"missed": [missed, missed]}, {"one": [0], "two": [1]})
    assert figure is not None
    assert [each.get_text() for each in figure.legends[0].get_texts()] == ["one", "two"]
    other: Any = influences([moved("a", "m", 0.5)], ["input: a"])
    assert other is not None
    for each in (figure, other):
        assert each.axes[0].get_subplotspec().get_geometry() == (1, 1, 0, 0)


def test_bars_have_room_whatever_their_number() -> None:
    """A fifth of an inch each, and an inch for title and axis."""
    missed = {"missed": ["; ".join(f"e{k}" for k in range(12))] * 2}
    one: Any = failures(missed, {"all": [0, 1]})
    two: Any = failures(missed, {"one": [0], "two": [1]})
    assert one is not None and two is not None
    assert 12 * 0.2 + 1.0 <= one.get_figheight() < two.get_figheight() < 10.0
    assert two.get_figheight() >= 24 * 0.2 + 1.0
