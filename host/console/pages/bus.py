"""The bus: nodes with their error states, load, decoded frames, and faults that can be made."""

from __future__ import annotations

from nicegui import ui

from host.console.shell import Shell, box, button, table
from host.console.views import BusView

FRAMES = 25


def bus(shell: Shell, view: BusView) -> None:
    """The page."""
    with shell.page("/bus", "Bus"), ui.element("div").classes("boxes"):
        with box("Load and errors"):
            load = ui.label("–").classes("big")
            errors = ui.label("–").classes("small")
        with box("Nodes"):
            nodes = table(("node", "supply", "state", "TEC", "REC"))
        with box("Faults"):
            _faults(shell, view)
        with box("Frames", wide=True):
            running = ui.switch("follow", value=True).props('aria-label="Follow the frames"')
            frames = table(("t, s", "from", "id", "data", "says"))

    def refresh() -> None:
        load.set_text(f"{100 * view.load():.1f} % load")
        found = view.errors()
        errors.set_text(", ".join(f"{name} {count}" for name, count in found.items() if count) or "no errors")
        nodes([(n.name, "on" if n.powered else "OFF", n.state, str(n.tec), str(n.rec)) for n in view.nodes()])
        if running.value:
            frames(
                [
                    (f"{f.t_s:.4f}", f.sender, f"{f.identifier:03X}", f.data.hex(" "), f.text)
                    for f in reversed(view.frames(FRAMES))
                ]
            )

    shell.each(refresh)


def _faults(shell: Shell, view: BusView) -> None:
    names = view.faults()
    if not names:
        ui.label("This is no emulated bus: nothing can be broken from here.").classes("mid")
        return
    chosen = shell.control(ui.select(list(names), value=names[0], label="Board").props("outlined dense"))
    with ui.row():
        for text, on in (("Cut its supply", False), ("Give it back", True)):
            shell.control(button(text, on_click=lambda state=on: view.switch(chosen.value, state)))
