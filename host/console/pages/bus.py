"""The bus: nodes with their error states, load, decoded frames, and faults that can be made."""

import asyncio
from concurrent.futures import Future

from nicegui import ui

from host.console.shell import Shell, box, button, log_of, table
from host.console.views import BusView, words
from host.logs.journal import Entry

LINES = 14
ANSWER_S = 5.0
"""Wall time until the next slice must have come. ASSUMPTION: slices are a millisecond."""


def bus(shell: Shell, view: BusView) -> None:
    """The page."""
    with shell.page("/bus", "Bus"), ui.element("div").classes("boxes"):
        with box("Load and errors"):
            load = ui.label("–").classes("big")
            errors = ui.label("–").classes("small")
        with box("Nodes"):
            nodes = table(("node", "supply", "state", "TEC", "REC", "load, %"))
        with box("Supply of the boards"):
            _supply(shell, view)
        with box("Faults"):
            _faults(shell, view)
        with box("Commands and boards, UTC", wide=True):
            journal = shell.telescope.journal.entries
            log_of(shell, "Commands and boards", lambda: _entries(list(journal.copy())[-LINES:]))
        with box("Frames", wide=True):
            running = ui.switch("follow", value=True).props('aria-label="Follow the frames"')
            frames = table(("t, s", "from", "id", "data", "says"))

    @shell.each
    def refresh() -> None:
        now = view.look()
        load.set_text(f"{100 * now.load:.1f} %")
        counts = (f"{name} {count}" for name, count in now.errors.items() if count)
        errors.set_text(f"of the last second; {', '.join(counts) or 'no errors'}")
        nodes(
            [
                (n.name, "on" if n.powered else "OFF", n.state, str(n.tec), str(n.rec), f"{100 * n.load:.2f}")
                for n in now.nodes
            ]
        )
        if running.value:
            frames(
                [
                    (f"{t_ns * 1e-9:.4f}", sender, f"{number:03X}", data.hex(" "), words(number, data))
                    for t_ns, sender, number, data in reversed(now.frames)
                ]
            )


def _entries(entries: list[Entry]) -> list[tuple[float, str]]:
    return [(entry.t_s, f"{entry.where}: {entry.text}") for entry in entries]


def _supply(shell: Shell, view: BusView) -> None:
    names = view.boards
    if not names:
        ui.label("This is no emulated bus: nothing can be broken from here.").classes("mid")
        return
    chosen = shell.field(ui.select(list(names), value=names[0], label="Board"))
    with ui.row():
        for text, on in (("Cut its supply", "off"), ("Give it back", "on")):
            shell.control(button(text, on_click=lambda state=on: view.wish(f"power {chosen.value} {state}")))


def _faults(shell: Shell, view: BusView) -> None:
    """Any fault of the table, with its arguments; what is on, and its end."""
    kinds = {kind.name: kind for kind in view.kinds}
    if not kinds:
        return
    first = next(iter(kinds.values()))
    names = {name: f"{kind.level}: {name}" for name, kind in kinds.items()}
    chosen = shell.field(ui.select(names, value=first.name, label="Fault"), wide=True)
    text = ui.label(first.text).classes("small")
    given = shell.field(ui.input("Arguments, name=value", value=first.needed), wide=True)
    hint = ui.label(first.arguments).classes("small")

    def show() -> None:
        kind = kinds[chosen.value]
        text.set_text(kind.text)
        given.set_value(kind.needed)
        hint.set_text(kind.arguments)

    chosen.on_value_change(show)

    async def start() -> None:
        await _tell(shell, view.wish(f"fault start {chosen.value} {given.value or ''}"))

    shell.control(button("Start it", on_click=start))
    fill = table(("number", "on"))
    with ui.row().classes("items-center"):
        number = shell.field(ui.number("Number", value=0, min=0, format="%d").classes("w-24"))

        async def clear() -> None:
            await _tell(shell, view.wish(f"fault clear {int(number.value or 0)}"))

        shell.control(button("Clear it", on_click=clear))
    shell.each(lambda: fill([(str(each), text) for each, text in view.look().running]))


async def _tell(shell: Shell, future: Future[str]) -> None:
    try:
        shell.say(await asyncio.wait_for(asyncio.wrap_future(future), ANSWER_S))
    except ValueError as error:
        shell.say(str(error), bad=True)
    except TimeoutError:
        shell.say("no slice of time has come; is it paused?", bad=True)
