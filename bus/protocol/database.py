"""schmidt.dbc, loaded by cantools (slow to import, so only when asked for)."""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cantools.database import Database

DBC_PATH = Path(__file__).with_name("schmidt.dbc")


@cache
def database() -> "Database":
    """The protocol as a cantools database; `decode_message(identifier, data)` decodes any frame of a run."""
    from cantools.database import Database, load_file

    loaded = load_file(DBC_PATH, strict=True)
    assert isinstance(loaded, Database)
    return loaded
