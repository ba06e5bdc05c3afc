"""The four ASCII logs (H6): user commands, device status, sensor data, errors.

They do not grow for ever where they rotate: a full file is put aside under a number, the oldest is dropped.
"""

from collections.abc import Callable
from pathlib import Path

from host.logs.files import LineFile
from host.logs.journal import Logs

_FILES = {
    "command": ("commands", "# utc  t_s  node  command  result"),
    "status": ("status", "# utc  t_s  device  status"),
    "sensors": ("sensors", "# utc  t_s  sensor=value …"),
    "error": ("errors", "# utc  t_s  where  what"),
}
"""Name and first line by what is kept."""


class AsciiLogs(Logs):
    """Four files in one folder; every line starts with UTC and the simulated time in seconds."""

    def __init__(
        self, folder: Path, utc: Callable[[float], str], make: Callable[[Path], LineFile] | None = None
    ) -> None:
        """utc: text for a time in s. make: opens one file, such as `rotation.rotating`; None: one that
        grows."""
        self._utc = utc
        make = make or _growing
        self._files = {kind: make(folder / f"{name}.log") for kind, (name, _) in _FILES.items()}
        for kind, file in self._files.items():
            file.write(_FILES[kind][1] + "\n")

    @property
    def error_entries(self) -> int:
        """Lines in the error log so far, without its header."""
        return self._files["error"].lines - 1

    def files(self) -> list[LineFile]:
        """The four files."""
        return list(self._files.values())

    def close(self) -> None:
        """Bring all four to disk and close them."""
        for file in self._files.values():
            file.close()

    def flush(self) -> None:
        """Bring all four to disk."""
        for file in self._files.values():
            file.flush()

    def _keep(self, kind: str, t_ns: int, *words: str) -> None:
        t_s = t_ns / 1e9
        self._files[kind].write(f"{self._utc(t_s)}  {t_s:.3f}  {'  '.join(words)}\n")


def _growing(path: Path) -> LineFile:
    return LineFile(path, buffer_bytes=1 << 13)


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
