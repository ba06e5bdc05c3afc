"""Logs that do not grow for ever: a full file is put aside under a number, the oldest is dropped (H6)."""

from pathlib import Path

from host.logs.files import LineFile

FULL_BYTES = 10_000_000
"""Size at which a log is put aside: about six hours of the sensor log at four lines a second. ASSUMPTION."""
KEPT = 9
"""Files put aside per log, `NAME.log.1` being the youngest. ASSUMPTION."""
_BUFFER_BYTES = 1 << 13


class RotatingFile(LineFile):
    """A `LineFile` that starts afresh, with its header, when it is full or when it finds one of an earlier
    session. Whole lines only ever stand in one file."""

    def __init__(self, path: Path, full_bytes: int = FULL_BYTES, kept: int = KEPT) -> None:
        self._full_bytes = full_bytes
        self._kept = kept
        self._bytes = 0
        self._header = ""
        if path.exists() and path.stat().st_size:
            put_aside(path, kept)
        super().__init__(path, _BUFFER_BYTES)

    def write(self, text: str) -> None:
        """Append whole lines; the first one is the header every further file begins with."""
        if not self._header:
            self._header = text
        size = len(text.encode())
        if self._bytes and self._bytes + size > self._full_bytes:
            self.close()
            put_aside(self.path, self._kept)
            self.reopen()
            self._bytes = len(self._header.encode())
            super().write(self._header)
        self._bytes += size
        super().write(text)


def rotating(path: Path) -> LineFile:
    """A rotating file of the usual size; give it to `AsciiLogs`."""
    return RotatingFile(path)


def put_aside(path: Path, kept: int) -> None:
    """Give a file the number 1, and those that have one the next; the last of `kept` is gone."""
    names = [path.with_name(f"{path.name}.{number}") for number in range(1, kept + 1)]
    for younger, older in zip(reversed([path, *names][:-1]), reversed(names), strict=True):
        if younger.exists():
            younger.replace(older)
