"""Focus console (H3): single steps, Move To, hold and free, LVDT and encoder; the focus curve."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from nicegui import ui

from bus.protocol import Device, FocusFlag
from host.console.figures import number
from host.console.plots import options
from host.console.shell import Shell, box, button, stale
from host.telescope import Telescope

MICRONS = 6.25
"""Per half step (paper, section 4)."""
LVDT_MM = 10.0 / 1024
"""Per ADC count: 10 bit over ±5 mm (hardware.md 1.3)."""


def focus(shell: Shell) -> None:
    """The page."""
    with shell.page("/focus", "Focus console"), ui.element("div").classes("boxes"):
        _readings(shell)
        _moves(shell)
        _power(shell)
        curve(shell)


def _readings(shell: Shell) -> None:
    with box("Position"):
        with ui.row().classes("items-center"):
            lamp = ui.element("span").classes("lamp").props('role="img" aria-label="not moving"')
            steps = ui.label("–").classes("big")
        with ui.element("div").classes("pair"):
            labels = {}
            for name in ("from the middle", "LVDT", "encoder", "state"):
                ui.label(name).classes("small")
                labels[name] = ui.label("–").classes("mid")

    @shell.each
    def refresh() -> None:
        now = shell.desk.now.focus
        moving = now is not None and bool(now.flags & FocusFlag.MOVING)
        lamp.classes(add="on" if moving else None, remove=None if moving else "on")
        lamp.props(f'aria-label="{"moving" if moving else "not moving"}"')
        for label in (steps, *labels.values()):
            stale(label, Device.FOCUS in shell.desk.now.stale)
        if now is None:
            return
        steps.set_text(f"{now.position:+d} half steps")
        labels["from the middle"].set_text(number(now.position * MICRONS / 1000, "+.4f", " mm"))
        labels["LVDT"].set_text(f"{now.lvdt} counts, {(now.lvdt - 512) * LVDT_MM:+.2f} mm")
        labels["encoder"].set_text(f"{now.encoder} counts")
        flags = FocusFlag(now.flags)
        words = ["free" if FocusFlag.FREE in flags else "hold" if FocusFlag.HOLD in flags else "energised"]
        words.append("referenced" if FocusFlag.REFERENCED in flags else "not referenced")
        labels["state"].set_text(", ".join(words))


def _moves(shell: Shell) -> None:
    with box("Move"):
        with ui.row():
            for step in (-10, -1, 1, 10):
                act = shell.doing(_step(step))
                shell.control(
                    button(f"{step:+d}", on_click=act).props(f'aria-label="Focus {step:+d} half steps"')
                )
        with ui.row().classes("items-center"):
            place = shell.field(ui.number("Half steps", value=0, min=-800, max=800, format="%d"))

            async def go() -> None:
                wanted = int(place.value or 0)
                await shell.attempt(shell.desk.do(lambda t: t.focuser.move_to(wanted)))

            shell.control(button("Move To", on_click=go))
        shell.control(button("Find reference", on_click=shell.doing(lambda t: t.focuser.reference())))


def _step(by: int) -> Callable[[Telescope], Any]:
    return lambda telescope: telescope.focuser.step(by)


def _power(shell: Shell) -> None:
    with box("Power"):
        shell.control(button("Motor power OFF: hold", on_click=shell.doing(lambda t: t.focuser.hold())))
        shell.control(button("Control power OFF: free", on_click=shell.doing(lambda t: t.focuser.free())))
        ui.label("Free lets go of the shaft: the reference is lost.").classes("small")


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
                    points.append((now.position, float(width.value)))

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
