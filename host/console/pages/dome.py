"""Dome and weather consoles (H7), as far as boards exist."""

from __future__ import annotations

from nicegui import ui

from host.console.shell import Shell, box


def dome(shell: Shell) -> None:
    """The page."""
    with shell.page("/dome", "Dome and weather"), ui.element("div").classes("boxes"):
        for name in ("dome", "weather"):
            with box(name.capitalize()):
                boards = [b for b in shell.desk.now.boards if b.device.name.startswith(name.upper())]
                if not boards:
                    ui.label(f"No {name} board on this network.").classes("mid")
                for board in boards:
                    ui.label(f"{board.device.name}: {'alive' if board.alive else 'silent'}").classes("mid")
