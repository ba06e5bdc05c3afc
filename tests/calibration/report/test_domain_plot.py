"""Effects over their domain and spectra: every number that is drawn, and the words beside it."""

import base64
import struct
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
import pytest

from calibration.decide.selection import Selection
from calibration.look.looked import Spectrum
from calibration.report import plots
from calibration.report.plots import BLUE, GREY, RED, domain_plot, spectrum_plot
from tests.calibration.report.drawn import effect, fit, legend, problem, selection

RNG = np.random.default_rng(5)


def test_a_figure_is_a_png_of_its_size_and_is_closed() -> None:
    fig, ax = plots.figure(4.0, 2.0)
    assert fig.get_size_inches().tolist() == [4.0, 2.0] and not ax.spines["top"].get_visible()
    assert plt.rcParams["axes.formatter.limits"] == [-6, 6] and not plt.rcParams["axes.spines.right"]
    said = plots.png(fig)
    head, _, data = said.partition(",")
    raw = base64.b64decode(data)
    assert head == "data:image/png;base64" and struct.unpack(">II", raw[16:24]) == (440, 220)
    assert not plt.fignum_exists(fig.number)
    two, axes = plots.figure(rows=2)
    assert len(axes) == 2 and two.get_size_inches().tolist() == [9.0, 3.4]
    plt.close(two)


def test_a_figure_with_nothing_says_why(figures: list[Any]) -> None:
    assert (
        plots.nothing_to_draw("torque", "no rows")
        == "data:image/png;base64," + base64.b64encode(b"figure").decode()
    )
    (ax,) = figures[0].axes
    assert ax.get_title(loc="left") == "torque" and ax.texts[0].get_text() == "no rows"
    assert ax.get_legend() is None and not ax.axison


def chosen(n: int, held: int = 0, name: str = "drag", **more: Any) -> Selection:
    x = np.linspace(-1.0, 2.0, n)
    p = problem(np.zeros(n), held)
    return selection(p, effect(x, name, **more), after=fit(np.where(np.arange(n) % 2, 0.25, -0.25), 2.0))


def drawn(figures: list[Any], s: Selection, x: np.ndarray, odd: np.ndarray | None = None) -> Any:
    domain_plot(s, x, "angle, rad", "A title", 0, odd)
    return figures[-1].axes[0]


@pytest.mark.parametrize(("n", "cells"), [(100, 8), (180, 9), (300, 15), (4000, 80)])
def test_what_an_effect_leaves_is_drawn_over_its_domain(figures: list[Any], n: int, cells: int) -> None:
    s, x = chosen(n + 40, held=40), RNG.permutation(n + 40) * 0.1
    ax = drawn(figures, s, x)
    cloud, *_, mean, red = ax.lines
    column = np.linspace(-1.0, 2.0, n + 40)
    e = 2 * column + np.where(np.arange(n + 40) % 2, 0.25, -0.25)
    assert cloud.get_xdata().tolist() == x[:n].tolist() and cloud.get_ydata() == pytest.approx(e[:n])
    parts = np.array_split(np.argsort(x[:n]), cells)
    for line, y in ((mean, e), (red, 2 * column)):
        assert line.get_xdata() == pytest.approx([np.median(x[:n][c]) for c in parts])
        assert line.get_ydata() == pytest.approx([np.mean(y[:n][c]) for c in parts])
    bars = [b[1, 1] - b[0, 1] for b in ax.containers[0].lines[2][0].get_segments()]
    assert bars == pytest.approx([2 * np.std(e[:n][c]) / np.sqrt(max(len(c) / 10, 1)) for c in parts])
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("angle, rad", "residual, N m")
    assert ax.get_title(loc="left") == "A title"
    said = ["mean of a bin, standard error", "residual without the effect", "effect as fitted"]
    assert sorted(legend(ax)) == sorted(said)
    low, high = np.quantile(e[:n], [0.002, 0.998])
    assert ax.get_ylim() == pytest.approx((low - 0.2 * (high - low), high + 0.2 * (high - low)))
    assert (cloud.get_color(), mean.get_color(), red.get_color()) == (GREY, BLUE, RED)


def test_an_effect_that_changes_sign_is_drawn_with_the_direction(figures: list[Any]) -> None:
    odd = np.where(np.arange(100) < 50, -1.0, 1.0)
    plain = drawn(figures, chosen(100), np.arange(100.0)).lines[0].get_ydata()
    ax = drawn(figures, chosen(100), np.arange(100.0), odd)
    assert ax.lines[0].get_ydata() == pytest.approx(odd * plain)
    assert ax.get_ylabel() == "residual × direction, N m"


def test_a_function_without_a_name_has_no_level(figures: list[Any]) -> None:
    x = np.arange(100.0)
    named, unnamed = (drawn(figures, chosen(100, name=name), x) for name in ("drag", "unknown"))
    level = 2 * 0.5  # the mean of a line from -1 to 2, times the coefficient
    for k in (0, -1):
        assert unnamed.lines[k].get_ydata() == pytest.approx(named.lines[k].get_ydata() - level)


@pytest.mark.parametrize(("width", "cells"), [(0.05, 160), (0.2, 80)])
def test_a_narrow_pulse_has_bins_of_its_own(figures: list[Any], width: float, cells: int) -> None:
    ax = drawn(figures, chosen(4000, fixed={"width": (width, "turn")}), np.arange(4000.0))
    assert len(ax.lines[-1].get_xdata()) == cells


@pytest.mark.parametrize(("n", "points"), [(11_999, 11_999), (12_000, 6000)])
def test_a_cloud_has_about_six_thousand_points(figures: list[Any], n: int, points: int) -> None:
    assert len(drawn(figures, chosen(n), np.arange(float(n))).lines[0].get_xdata()) == points


@pytest.mark.parametrize(("n", "told"), [(19, True), (20, False)])
def test_fewer_than_twenty_rows_are_not_drawn(figures: list[Any], n: int, told: bool) -> None:
    ax = drawn(figures, chosen(n), np.arange(float(n)))
    assert [x.get_text() for x in ax.texts] == ["too few fitted rows to draw"] * told


STAGES = {"wheel": 1.0, "motor": 10.0, "slow": 0.9, "quick": 10.1}


@pytest.mark.parametrize("periods", [False, True])
def test_known_parts_and_found_lines_are_marked(
    figures: list[Any], monkeypatch: pytest.MonkeyPatch, periods: bool
) -> None:
    def amplitude(s: Selection, spectrum: Spectrum, e: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        return np.array([1.0, 4.0, 10.0]) if not periods else np.array([0.1, 0.5, 1.0]), e[:3]

    monkeypatch.setattr(plots, "_over_periods" if periods else "_over_orders", amplitude)
    column = np.ones(30)
    lines = [
        effect(column, kind="line", order=3.0, frequency=3.0),
        effect(column, kind="line", order=11.0, frequency=0.3),
        effect(column, order=2.0, frequency=2.0),
        effect(column, kind="line"),
    ]
    s = selection(problem(np.arange(30.0)), *lines, after=fit(np.full(30, 7.0), *[2.0] * 4))
    spectrum_plot(s, Spectrum(turns=column, stages=STAGES, label="cycles", periods=periods), "A title")
    ax = figures[0].axes[0]
    before, after, *marks = ax.lines
    assert before.get_ydata().tolist() == [0.0, 1.0, 2.0] and after.get_ydata().tolist() == [7.0] * 3
    assert legend(ax) == ["before", "after"] and (before.get_color(), after.get_color()) == (GREY, BLUE)
    places = [float(m.get_xdata()[0]) for m in marks]
    if periods:
        found = [1 / (3.0 * h) for h in (1, 2, 3)] + [1 / (0.3 * h) for h in range(4, 9)]
        assert places == pytest.approx([1.0, 0.1, *found])
    else:
        assert places == [1.0, 10.0, 3.0]
    assert [m.get_linestyle() for m in marks] == [":", ":", *["-"] * (len(marks) - 2)]
    assert marks[0].get_ydata() == [0, 1] and marks[-1].get_ydata() == [0, 0.05]
    assert [t.get_text() for t in ax.texts] == [" wheel", " motor"]
    bottom, top = ax.get_ylim()
    assert bottom == 0.0 and [t.get_position() for t in ax.texts] == [(places[k], top) for k in (0, 1)]
    assert (ax.get_xscale(), ax.get_xlabel(), ax.get_ylabel()) == ("log", "cycles", "amplitude, N m")
    assert ax.xaxis.get_major_formatter()(20.0, 0) == "20" and ax.xaxis.get_minor_formatter()(3.0, 0) == ""
    assert [x for x in ax.xaxis.get_major_locator().tick_values(1, 10) if 1 <= x <= 10] == [1, 2, 5, 10]


def test_a_spectrum_of_nothing_says_so(figures: list[Any]) -> None:
    spectrum = Spectrum(turns=np.zeros(30), stages={}, label="", periods=True)
    spectrum_plot(selection(problem(np.zeros(30))), spectrum, "A title")
    assert figures[0].axes[0].texts[0].get_text() == "too few fitted rows for a spectrum"
