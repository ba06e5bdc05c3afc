"""Figures of a campaign: distributions, what moves what, what fails first."""

from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt
from scipy.stats import binomtest, spearmanr

from scenarios.run.report.style import COLOURS, Figure, axes, new_figure, title

Array = npt.NDArray[np.float64]
LEVEL = 0.95
_NORMAL = 1.959964
"""Quantile of the normal distribution at the upper end."""
_FEWEST = 8
"""Fewer runs than this say nothing about a rank correlation."""


class Influence(NamedTuple):
    """Rank correlation of an input and a metric, its 95 % interval, and how many runs it is from."""

    input: str
    metric: str
    value: float
    low: float
    high: float
    runs: int


def influence(name: str, x: Array, metric: str, y: Array) -> Influence | None:
    """None where there are too few runs with both, or one of them never changes.

    The interval is Bonett and Wright's (2000, Psychometrika 65, 23): Fisher's z, variance
    (1 + r^2 / 2) / (n - 3).
    """
    good = np.isfinite(x) & np.isfinite(y)
    x, y = x[good], y[good]
    if len(x) < _FEWEST or np.ptp(x) == 0.0 or np.ptp(y) == 0.0:
        return None
    value = float(spearmanr(x, y).statistic)
    with np.errstate(divide="ignore"):  # of runs in the very same order
        z = np.arctanh(np.clip(value, -1.0, 1.0))
    half = _NORMAL * np.sqrt((1.0 + 0.5 * value * value) / (len(x) - 3))
    return Influence(name, metric, value, float(np.tanh(z - half)), float(np.tanh(z + half)), len(x))


def share(hits: int, runs: int) -> tuple[float, float, float]:
    """Share of hits and its 95 % interval by Wilson (1927, JASA 22, 209); (nan, 0, 1) without runs."""
    if not runs:
        return float("nan"), 0.0, 1.0
    wilson = binomtest(hits, runs).proportion_ci(LEVEL, method="wilson")
    return hits / runs, float(wilson.low), float(wilson.high)


Columns = dict[str, list[Any]]
_PANELS = 9
_BAR = "#9db7d5"
WORDS = 44


def numbers(columns: Columns, name: str) -> Array:
    """A column as floats, nan where there is nothing or no number."""
    return np.array(
        [each if isinstance(each, int | float) else np.nan for each in columns[name]], dtype=float
    )


def distributions(
    columns: Columns, metrics: list[str], limits: dict[str, tuple[float, bool]], units: dict[str, str]
) -> Figure | None:
    """A histogram per metric, its unit below it; a line where its limit lies, red where it is missed."""
    drawn = [name for name in metrics if np.ptp(_finite(numbers(columns, name))) > 0.0][:_PANELS]
    if not drawn:
        return None
    rows = -(-len(drawn) // 3)
    figure = new_figure(2.3 * rows + 0.3)
    for place, name in enumerate(drawn):
        values = _finite(numbers(columns, name))
        short = name.removeprefix("metric: ")
        label = "runs" if place % 3 == 0 else ""
        view = axes(figure, rows, 3, place + 1, xlabel=units.get(short, ""), ylabel=label)
        middle = np.quantile(values, [0.005, 0.995])
        bars: Any
        shown = np.clip(values, *middle)
        _, edges, bars = view.hist(shown, bins=30, color=_BAR)
        if short in limits:
            limit, upper = limits[short]
            for left, right, bar in zip(edges[:-1], edges[1:], bars, strict=True):
                inside = values[(shown >= left) & (shown <= right)]  # the last bar holds what lies beyond it
                if len(inside) and (inside.min() > limit if upper else inside.max() < limit):
                    bar.set_color(COLOURS["bad"])
            if middle[0] - np.ptp(middle) < limit < middle[1] + np.ptp(middle):
                view.axvline(limit, color=COLOURS["bad"], lw=1.2, ls="--")
        title(view, short[:WORDS])
    return figure


def influences(found: list[Influence], inputs: list[str]) -> Figure | None:
    """Rank correlation with its interval, a row per metric and input that moves it."""
    strong = sorted(found, key=lambda each: -abs(each.value))[:18]
    if not strong:
        return None
    strong.sort(key=lambda each: (each.metric, -abs(each.value)), reverse=True)
    figure = new_figure(0.27 * len(strong) + 1.0)
    view = axes(figure, 1, 1, 1, xlabel="Spearman's rank correlation, 95 % interval")
    palette = dict(zip(inputs, _PALETTE * (1 + len(inputs) // len(_PALETTE)), strict=False))
    for place, each in enumerate(strong):
        sure = each.low > 0.0 or each.high < 0.0
        colour = palette[each.input]
        view.plot([each.low, each.high], [place, place], color=colour, lw=1.6, alpha=1.0 if sure else 0.35)
        view.plot(each.value, place, "o", ms=5, color=colour if sure else "white", mec=colour)
    view.axvline(0.0, color="#5d6b7a", lw=0.8)
    view.set_yticks(
        range(len(strong)),
        [
            f"{e.metric.removeprefix('metric: ')[:WORDS]}  ←  {e.input.removeprefix('input: ')}"
            for e in strong
        ],
    )
    view.set_xlim(-1.05, 1.05)
    title(view, "What moves what (filled: the interval does not hold zero)")
    return figure


def failures(columns: Columns, groups: dict[str, list[int]]) -> Figure | None:
    """Share of runs in which each expectation is missed, with its interval, by group of runs."""
    missed = [set(filter(None, str(each or "").split("; "))) for each in columns["missed"]]
    names = sorted(
        {name for each in missed for name in each}, key=lambda n: sum(n in each for each in missed)
    )
    if not names:
        return None
    names = names[-12:]
    height = 0.8 / len(groups)
    figure = new_figure(max(2.2, 0.2 * len(names) * len(groups) + 1.2))
    view = axes(figure, 1, 1, 1, xlabel="share of runs in which it is missed, 95 % interval")
    for number, (label, runs) in enumerate(groups.items()):
        colour = _PALETTE[number % len(_PALETTE)]
        for place, name in enumerate(names):
            value, low, high = share(sum(name in missed[k] for k in runs), len(runs))
            y = place + 0.4 - (number + 0.5) * height
            known = label if place == 0 else None
            view.barh(y, value, height * 0.85, color=colour, alpha=0.85, label=known)
            view.plot([low, high], [y, y], color="#1c2530", lw=0.9)
    view.set_yticks(range(len(names)), [name[:WORDS] for name in names])
    view.set_xlim(0.0, 1.0)
    title(view, "What fails")
    if len(groups) > 1:
        figure.legend(fontsize=8, loc="outside lower center", ncols=len(groups), frameon=False)
    return figure


_PALETTE = [
    COLOURS["ra"],
    COLOURS["dec"],
    COLOURS["mean_1s"],
    COLOURS["star"],
    "#7a4fa3",
    "#5d6b7a",
    "#b3261e",
]


def _finite(values: Array) -> Array:
    found = values[np.isfinite(values)]
    return found if len(found) else np.zeros(1)
