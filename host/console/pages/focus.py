"""Focus console (H3): single steps, Move To, hold and free, LVDT and encoder four times a second."""

from collections.abc import Callable
from typing import Any

from nicegui import ui

from bus.protocol import Device
from host.console.figures import number
from host.console.pages.focuscurve import curve
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
        moving = now is not None and now.moving
        lamp.classes(add="on" if moving else None, remove=None if moving else "on")
        lamp.props(f'aria-label="{"moving" if moving else "not moving"}"')
        for label in (steps, *labels.values()):
            stale(label, Device.FOCUS in shell.desk.now.stale)
        if now is None:
            return
        steps.set_text(f"{now.half_steps:+d} half steps")
        labels["from the middle"].set_text(number(now.half_steps * MICRONS / 1000, "+.4f", " mm"))
        labels["LVDT"].set_text(f"{now.lvdt} counts, {(now.lvdt - 512) * LVDT_MM:+.2f} mm")
        labels["encoder"].set_text(f"{now.encoder} counts")
        words = ["free" if now.free else "hold" if now.hold else "energised"]
        words.append("referenced" if now.referenced else "not referenced")
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
