"""Live plots: four small ones over the last two minutes."""

from collections.abc import Sequence
from typing import Any

from nicegui import ui

from host.console.live import Sample
from host.console.shell import Shell, box
from host.console.theme import INK, LINE, SOFT

_EVERY = 4
"""A plot is sent once in so many ticks, once a second."""
DASHES = ("solid", "dashed")
"""In red light two lines differ better by form than by colour."""
SHOWN_S = 120
PANELS = (
    ("Position error, ″", ("RA", "Dec"), lambda s: s.error_arcsec),
    ("Rate, ″/s", ("RA", "Dec"), lambda s: s.rate_arcsec_s),
    ("Effort, %", ("RA", "Dec"), lambda s: s.effort_percent),
    ("Motor current, A", ("RA A", "RA B", "Dec A", "Dec B"), lambda s: s.current_a),
)


def plots(shell: Shell) -> None:
    """The four of them."""
    for title, names, pick in PANELS:
        with box(title):
            chart = ui.echart(options(names, "night")).classes("w-full").style("height: 11rem")
            chart.props(f'role="img" aria-label="{title} over the last two minutes"')
            shell.each(_refresher(shell, chart, names, pick))


def _refresher(shell: Shell, chart: Any, names: tuple[str, ...], pick: Any) -> Any:
    count = 0

    def refresh() -> None:
        nonlocal count
        count += 1
        if count % _EVERY != 1:
            return
        samples = list(shell.live.samples)
        fresh = options(names, "day" if shell.day else "night")
        chart.options.update({key: value for key, value in fresh.items() if key != "series"})
        for k, one in enumerate(series(samples, pick, len(names))):
            chart.options["series"][k]["data"] = one
        chart.update()

    return refresh


def series(samples: Sequence[Sample], pick: Any, count: int) -> list[list[list[float | None]]]:
    """Points (s before now, value) of every line, of the time the plot shows: what is older would still
    stretch its vertical axis."""
    if not samples:
        return [[] for _ in range(count)]
    now = samples[-1].t_s
    shown = [s for s in samples if now - s.t_s <= SHOWN_S]
    return [[[round(s.t_s - now, 2), _short(pick(s)[k])] for s in shown] for k in range(count)]


def _short(value: float | None) -> float | None:
    return None if value is None else round(value, 4)


def options(names: tuple[str, ...], mode: str) -> dict[str, Any]:
    """An echarts description in the console's colours."""
    text = {"color": INK[mode]}
    axis = {"axisLabel": text, "splitLine": {"lineStyle": {"color": LINE[mode]}}}
    return {
        "animation": False,
        "color": [INK[mode], SOFT[mode], "#16202c" if mode == "day" else "#ff8f80", "#888888"],
        "grid": {"left": 55, "right": 24, "top": 24, "bottom": 24},
        "legend": {"textStyle": text, "top": 0},
        "xAxis": {"type": "value", "min": -SHOWN_S, "max": 0, "name": "s", "nameTextStyle": text, **axis},
        "yAxis": {"type": "value", "scale": True, **axis},
        "series": [
            {"name": name, "type": "line", "symbol": "none", "lineStyle": {"type": DASHES[k % 2]}, "data": []}
            for k, name in enumerate(names)
        ],
    }
