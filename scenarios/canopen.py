"""The EDS files of the boards: `schmidt eds DIR`."""

from __future__ import annotations

from io import StringIO
from pathlib import Path

from boards.core import Board
from scenarios.served import network


def eds(board: Board) -> str:
    """The electronic data sheet of a board, as text."""
    import canopen

    from boards.canopen import dictionary

    text = StringIO()
    canopen.export_od(dictionary(board), text, "eds")
    return text.getvalue()


def write_eds(folder: Path, scenario: Path | None = None, name: str | None = None) -> list[Path]:
    """One file per type of board into `folder`, node numbers of the first of each, boards of one's own too.

    scenario, name: whose network (neither: `lab`). Raises OSError when it cannot be written, ValueError
    subclasses for a scenario that cannot be used.
    """
    from boards.canopen.dictionary import type_of

    made = network(scenario, network_name=name)
    folder.mkdir(parents=True, exist_ok=True)
    boards = {type_of(board)[0].lower(): board for board in reversed(made.boards.values())}
    written = []
    for kind, board in sorted(boards.items()):
        file = folder / f"{kind}.eds"
        file.write_text(eds(board), encoding="utf-8")
        written.append(file)
    return written
