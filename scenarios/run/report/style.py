"""How figures of a run look: one palette, quiet axes, no more points than a page can show."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from host.logs.traces import extremes
from scenarios.run.outcome import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure as Figure
else:
    Figure = Any  # matplotlib is of an extra

COLOURS = {
    "ra": "#1f5fa8",
    "dec": "#c8631e",
    "truth": "#1f5fa8",
    "counts_5ms": "#8a94a0",
    "mean_1s": "#0c7a5b",
    "star": "#e0a020",
    "ok": "#0c7a5b",
    "bad": "#b3261e",
}
_WIDTH_IN = 9.6
_POINTS = 4000


def new_figure(height_in: float, width_in: float = _WIDTH_IN) -> Figure:
    """A figure with the project's fonts and spacing."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width_in, height_in), dpi=110, layout="constrained")


def axes(
    figure: Figure, rows: int, columns: int, index: int | tuple[int, int], xlabel: str = "", ylabel: str = ""
) -> Axes:
    """A plot of the figure with quiet axes."""
    view: Any = figure.add_subplot(rows, columns, index)
    view.spines[["top", "right"]].set_visible(False)
    view.grid(True, color="#e6e9ed", lw=0.6)
    view.set_axisbelow(True)
    view.set_xlabel(xlabel, fontsize=9)
    view.set_ylabel(ylabel, fontsize=9)
    view.tick_params(labelsize=8)
    return view  # type: ignore[no-any-return]


def title(view: Axes, text: str) -> None:
    """A title at the left end."""
    view.set_title(text, loc="left", fontsize=10)


def thin(t: Array, values: Array, points: int = _POINTS) -> tuple[Array, Array]:
    """At most about `points` samples; of every stretch the extremes are kept, so that no peak is lost."""
    picked = extremes(values, max(1, -(-2 * len(t) // points)))
    return t[picked], values[picked]
