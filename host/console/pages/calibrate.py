"""Record a run, have the finder look at it, and show what it says."""

import asyncio
from collections.abc import Callable
from html import escape

from nicegui import ui

from host.console.plots import plots
from host.console.runs import RecordedRuns
from host.console.shell import Shell, box, button

REPORTS = "/reports"


def calibrate(shell: Shell, runs: RecordedRuns) -> None:
    """The page."""
    with shell.page("/calibrate", "Calibrate"), ui.element("div").classes("boxes filled"):
        with box("Record"):
            ui.label("Both axes, as their boards send it over RS232, one file a run.").classes("small")
            state = ui.label().classes("mid").props('role="status"')
            with ui.row():
                shell.control(button("Start a run", on_click=lambda: _tell(shell, runs.start)))
                shell.control(button("End the run", on_click=lambda: _tell(shell, runs.stop)))
        with box("Ask the finder"):
            axis = shell.control(ui.radio(["ra", "dec"], value="ra").props('inline aria-label="Axis"'))
            said = ui.html(sanitize=False).props('role="log" aria-label="What the finder says"')
            link = ui.link("Report", "").classes("mid")
            link.set_visibility(False)

            async def ask() -> None:
                logs = runs.logs(axis.value)
                if not logs:
                    shell.say("record a run first", bad=True)
                    return
                name = f"report-{axis.value}-{len(logs)}"
                link.set_visibility(False)
                said.set_content('<pre class="lines">looking …</pre>')
                text, status = await run(runs.command(axis.value, runs.folder / name))
                said.set_content(f'<pre class="lines">{escape(text)}</pre>')
                if status == 0:
                    link.props(f'href="{REPORTS}/{name}/report.html"')
                    link.set_visibility(True)

            shell.control(button("Calibrate on the recorded runs", on_click=ask))

        plots(shell)

    @shell.each
    def refresh() -> None:
        count = len(runs.logs("ra"))
        state.set_text(f"recording run {count + 1}" if runs.recording else f"{count} runs recorded")


def _tell(shell: Shell, act: Callable[[], None]) -> None:
    try:
        act()
    except (OSError, ValueError) as error:
        shell.say(str(error), bad=True)


async def run(command: list[str]) -> tuple[str, int]:
    """What a program printed, and its exit status."""
    process = await asyncio.create_subprocess_exec(
        *command, stdout=asyncio.subprocess.PIPE, stderr=asyncio.subprocess.STDOUT
    )
    printed, _ = await process.communicate()
    return printed.decode("utf-8", "replace")[-4000:], process.returncode or 0
