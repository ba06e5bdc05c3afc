"""What the host has to say, kept for whoever looks and passed on to the ASCII logs (H2, H6)."""

from collections import deque
from collections.abc import Callable
from functools import partial
from pathlib import Path
from typing import NamedTuple

from host.logs.files import LineFile

KEPT = 1000
"""Entries kept for status windows; the files keep all. ASSUMPTION: an hour of a quiet night."""


class Logs:
    """Where commands, status, readings and errors go; whoever keeps them writes `_keep`."""

    def command(self, t_ns: int, node: str, text: str, result: str) -> None:
        """A command of the user and what came of it."""
        self._keep("command", t_ns, node, text, result)

    def status(self, t_ns: int, device: str, text: str) -> None:
        """What a device says about itself, or what the programme is doing."""
        self._keep("status", t_ns, device, text)

    def sensors(self, t_ns: int, text: str) -> None:
        """A line of readings."""
        self._keep("sensors", t_ns, text)

    def error(self, t_ns: int, where: str, text: str) -> None:
        """Something that went wrong."""
        self._keep("error", t_ns, where, text)

    def _keep(self, kind: str, t_ns: int, *words: str) -> None:
        raise NotImplementedError


class Entry(NamedTuple):
    """One event; kind is `command`, `status` or `error`; number counts from 1 without a gap."""

    number: int
    t_s: float
    kind: str
    where: str
    text: str


class Journal(Logs):
    """Keeps the last entries but readings; hands all on, to files and to listeners on the ticking thread."""

    def __init__(self, files: Logs | None = None) -> None:
        self.entries: deque[Entry] = deque(maxlen=KEPT)
        self.listeners: list[Callable[[Entry], None]] = []
        self.errors = 0
        self._number = 0
        self._files = files

    def since(self, number: int) -> list[Entry]:
        """Entries after `number` that are still kept; safe from any thread."""
        return [entry for entry in self.entries.copy() if entry.number > number]

    def _keep(self, kind: str, t_ns: int, *words: str) -> None:
        if self._files is not None:
            self._files._keep(kind, t_ns, *words)
        if kind == "sensors":
            return
        self.errors += kind == "error"
        self._number += 1
        entry = Entry(self._number, t_ns * 1e-9, kind, words[0], ": ".join(words[1:]))
        self.entries.append(entry)
        for listener in self.listeners:
            listener(entry)


_BUFFER_BYTES = 1 << 13
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
        """utc: text for a time in s. make: opens one file, such as `RotatingFile`; None: one that grows."""
        self._utc = utc
        make = make or partial(LineFile, buffer_bytes=_BUFFER_BYTES)
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


FULL_BYTES = 10_000_000
"""Size at which a log is put aside: about six hours of the sensor log at four lines a second. ASSUMPTION."""
KEPT_FILES = 9
"""Files put aside per log, `NAME.log.1` being the youngest. ASSUMPTION."""


class RotatingFile(LineFile):
    """A `LineFile` that starts afresh, with its header, when it is full or when it finds one of an earlier
    session. Whole lines only ever stand in one file."""

    def __init__(self, path: Path, full_bytes: int = FULL_BYTES, kept: int = KEPT_FILES) -> None:
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


def put_aside(path: Path, kept: int) -> None:
    """Give a file the number 1, and those that have one the next; the last of `kept` is gone."""
    names = [path.with_name(f"{path.name}.{number}") for number in range(1, kept + 1)]
    for younger, older in zip(reversed([path, *names][:-1]), reversed(names), strict=True):
        if younger.exists():
            younger.replace(older)
