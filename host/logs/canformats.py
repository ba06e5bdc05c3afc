"""A finished can.log in the formats of other tools, by python-can's own writers; times are UTC there."""

from datetime import datetime
from pathlib import Path
from typing import Final

from host.logs.files import LogError

FORMATS: Final = ("mf4", "blf", "asc")


def convert(log: Path, ending: str, start_utc: str) -> Path:
    """Write can.ENDING beside a can.log; returns its path. start_utc: of the log, ISO 8601.

    Raises LogError when it cannot be written.
    """
    import can

    start_s = datetime.fromisoformat(start_utc).timestamp()

    target = log.with_suffix(f".{ending}")
    try:
        with can.CanutilsLogReader(str(log)) as reader, can.Logger(str(target)) as writer:
            for message in reader:
                message.timestamp += start_s
                writer(message)
    except OSError as error:
        raise LogError(f"{target}: {error.strerror or error}") from None
    return target
