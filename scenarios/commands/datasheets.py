"""The EDS files of the boards: `schmidt eds DIR`."""

from io import StringIO
from pathlib import Path

from boards.core import Board
from host.logs.files import write_file
from scenarios.lab.wiring import network

_FILE = {
    "FileVersion": "1", "FileRevision": "1", "Description": "schmidt",
    "CreatedBy": "schmidt", "ModifiedBy": "schmidt",
    "CreationDate": "01-01-2026", "CreationTime": "12:00AM",
    "ModificationDate": "01-01-2026", "ModificationTime": "12:00AM",
}  # fmt: skip
"""Of the section FileInfo (CiA 306). The same dates whenever it is written: the same bytes."""


def eds(board: Board) -> str:
    """The electronic data sheet of a board, as text."""
    from canopen.objectdictionary.eds import export_eds

    from boards.canopen import dictionary
    from boards.canopen.dictionary import type_of

    text = StringIO()
    export_eds(dictionary(board), text, {"FileName": f"{type_of(board)[0].lower()}.eds", **_FILE})
    return text.getvalue()


def write_eds(folder: Path, scenario: Path | None = None, name: str | None = None) -> list[Path]:
    """One file per type of board into `folder`, node numbers of the first of each, boards of one's own too;
    and `canopen.dbc`.

    scenario, name: whose network (neither: `lab`). Raises OSError when it cannot be written, ValueError
    subclasses for a scenario that cannot be used.
    """
    from boards.canopen import canopen_dbc
    from boards.canopen.dictionary import type_of

    made = network(scenario, network_name=name)
    boards = {type_of(board)[0].lower(): board for board in reversed(made.boards.values())}
    written = []
    for kind, board in sorted(boards.items()):
        file = folder / f"{kind}.eds"
        write_file(file, eds(board))
        written.append(file)
    file = folder / "canopen.dbc"
    write_file(file, canopen_dbc(made.devices))
    return [*written, file]
