"""Live plots: four small ones over the last two minutes."""

import math
from collections.abc import Sequence
from typing import Any

from nicegui import ui

from host.console.live import Sample
from host.console.shell import Shell, box, seldom
from host.console.views import INK, LINE, SOFT

DASHES = ("solid", "dashed")
"""In red light two lines differ better by form than by colour."""
SHOWN_S = 120
_INNER = {"showMinLabel": False, "showMaxLabel": False}
"""The ends of an axis are no round figures."""
PANELS = (
    ("Position error, ″", ("RA", "Dec"), lambda s: s.error_arcsec, 0.2),
    ("Rate, ″/s", ("RA", "Dec"), lambda s: s.rate_arcsec_s, 1.0),
    ("Effort, %", ("RA", "Dec"), lambda s: s.effort_percent, 1.0),
    ("Motor current, A", ("RA A", "RA B", "Dec A", "Dec B"), lambda s: s.current_a, 0.02),
)


def plots(shell: Shell) -> None:
    """The four of them."""
    for title, names, pick, least in PANELS:
        with box(title):
            rms = ui.label().classes("small") if pick is PANELS[0][2] else None
            chart = ui.echart(options(names, "night")).classes("w-full plot")
            chart.props(f'role="img" aria-label="{title} over the last two minutes"')
            shell.each(_refresher(shell, chart, names, pick, least))
            if rms is not None:
                shell.each(_telling(shell, rms))


def _telling(shell: Shell, label: ui.label) -> Any:
    return lambda: label.set_text(rms_text(shell.live.samples))


def _refresher(shell: Shell, chart: Any, names: tuple[str, ...], pick: Any, least: float) -> Any:
    def refresh() -> None:
        samples = list(shell.live.samples)
        fresh = options(names, "day" if shell.day else "night")
        lines = series(samples, pick, len(names))
        fresh["yAxis"] |= span([y for line in lines for _, y in line if y is not None], least)
        for k, one in enumerate(lines):
            chart.options["series"][k]["data"] = one
        chart.options.update({key: value for key, value in fresh.items() if key != "series"})
        chart.update()

    return seldom(refresh)


def span(values: Sequence[float], least: float) -> dict[str, float]:
    """Ends of the vertical axis: of all values, but for what a tenth at either end does alone. least: its
    height when nothing happens."""
    found = sorted(values) or [0.0]
    cut = len(found) // 10
    low, high = found[cut], found[-1 - cut]
    room = max(high - low, least)
    middle = (low + high) / 2
    return {
        "min": round(min(max(found[0], low - room) - 0.05 * room, middle - least / 2), 3),
        "max": round(max(min(found[-1], high + room) + 0.05 * room, middle + least / 2), 3),
    }


def rms_text(samples: Sequence[Sample]) -> str:
    """Of the position errors that the plot shows, axis by axis."""
    said = []
    for k, name in enumerate(PANELS[0][1]):
        shown = [y for _, y in series(samples, PANELS[0][2], 2)[k] if y is not None]
        said.append(
            f"{name} {math.sqrt(sum(y * y for y in shown) / len(shown)):.2f}″" if shown else f"{name} –"
        )
    return f"rms of {SHOWN_S} s: {', '.join(said)}"


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
    line = {"lineStyle": {"color": LINE[mode]}}
    axis = {"axisLabel": text, "splitLine": line, "axisLine": line, "axisTick": line}
    return {
        "animation": False,
        "color": [
            INK[mode],
            SOFT[mode],
            "#16202c" if mode == "day" else "#ff8f80",
            "#7a5a2a" if mode == "day" else "#8a3026",
        ],
        "grid": {"left": 55, "right": 24, "top": 24, "bottom": 24},
        "legend": {"textStyle": text, "top": 0},
        "xAxis": {"type": "value", "min": -SHOWN_S, "max": 0, "name": "s", "nameTextStyle": text, **axis},
        "yAxis": {"type": "value", "scale": True, **axis, "axisLabel": text | _INNER},
        "series": [
            {"name": name, "type": "line", "symbol": "none", "lineStyle": {"type": DASHES[k % 2]}, "data": []}
            for k, name in enumerate(names)
        ],
    }
