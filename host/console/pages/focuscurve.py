"""The focus curve: star widths that somebody has measured, by focus position, and where they are least."""

from collections.abc import Sequence

import numpy as np
from nicegui import ui

from host.console.plots import options
from host.console.shell import Shell, box, button

LEAST = 4
"""Points from which a best focus is told: three fit any parabola."""


def best(points: Sequence[tuple[float, float]]) -> tuple[float, float, float] | None:
    """(a, x, b) of width² = a + b (position - x)², the hyperbola of a cone of light and a spot. None when the
    points have no least width."""
    if len({position for position, _ in points}) < LEAST:
        return None
    position, width = np.array(points).T
    b, linear, offset = np.polyfit(position, width**2, 2)
    if b <= 0:
        return None
    return float(offset - linear**2 / (4 * b)), float(-linear / (2 * b)), float(b)


def curve(shell: Shell) -> None:
    """The box; its points are the same on all pages until the consoles end."""
    points = shell.live.widths
    with box("Focus curve", wide=True):
        chart = ui.echart(options(("measured", "fit"), "night")).classes("w-full").style("height: 18rem")
        chart.props('role="img" aria-label="Star width by focus position"')
        said = ui.label().classes("mid").props('role="status"')
        with ui.row().classes("items-center"):
            width = shell.field(ui.number("Star width here, ″ or pixels", value=3.0, min=0.01))

            def add() -> None:
                now = shell.desk.now.focus
                if now is None or not width.value or width.value <= 0:
                    shell.say("a width above 0 is needed, and a focus that tells where it is", bad=True)
                else:
                    points.append((now.half_steps, float(width.value)))

            async def go() -> None:
                found = best(points)
                if found is None:
                    shell.say(
                        f"the best focus needs {LEAST} positions with the least width between", bad=True
                    )
                else:
                    await shell.attempt(shell.desk.do(lambda t: t.focuser.move_to(round(found[1]))))

            shell.control(button("Add this point", on_click=add))
            shell.control(button("Go to the best focus", on_click=go))
            shell.control(button("Clear the points", on_click=points.clear))
    shown: list[object] = [None]

    @shell.each
    def refresh() -> None:
        if (state := (len(points), shell.day)) == shown[0]:
            return
        shown[0] = state
        fresh, found = options(("measured", "fit"), "day" if shell.day else "night"), best(points)
        fresh["xAxis"] |= {"min": "dataMin", "max": "dataMax", "name": "half steps"}
        fresh["series"][0] |= {"type": "scatter", "symbol": "circle", "data": [list(each) for each in points]}
        if found is not None:
            a, x, b = found
            ends = min(each[0] for each in points), max(each[0] for each in points)
            along = np.linspace(*ends, 60)
            fitted = np.sqrt(np.maximum(a + b * (along - x) ** 2, 0.0))
            fresh["series"][1]["data"] = [
                [round(float(p), 1), float(w)] for p, w in zip(along, fitted, strict=True)
            ]
        said.set_text(
            f"{len(points)} points" if found is None else f"best focus at {found[1]:+.0f} half steps"
        )
        chart.options.update(fresh)
        chart.update()
