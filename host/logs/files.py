"""A text file that grows line by line and stays readable whatever happens to the disk."""

from __future__ import annotations

import hashlib
import os
from pathlib import Path

_BUFFER_BYTES = 1 << 16


class LogError(ValueError):
    """A log cannot be written; the message says which and why."""


class LineFile:
    """Lines to a file, buffered, with a running SHA-256 of what was written.

    When the disk fills up in the middle of a line, the file is cut back to its last whole line.
    """

    def __init__(self, path: Path, buffer_bytes: int = _BUFFER_BYTES) -> None:
        self.path = path
        self.lines = 0
        self._digest = hashlib.sha256()
        self._waiting: list[str] = []
        self._waiting_bytes = 0
        self._limit = buffer_bytes
        self._whole = 0  # bytes up to the last whole line on disk
        try:
            self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        except OSError as error:
            raise LogError(f"{path}: cannot be written: {error.strerror}") from None

    def write(self, text: str) -> None:
        """Append whole lines (`text` ends with a newline)."""
        self._waiting.append(text)
        self._waiting_bytes += len(text)
        self.lines += 1
        if self._waiting_bytes >= self._limit:
            self.flush()

    def flush(self) -> None:
        """Bring everything to the operating system; raises `LogError` when it does not fit."""
        if not self._waiting or self._descriptor < 0:
            return
        data = "".join(self._waiting).encode()
        self._waiting.clear()
        self._waiting_bytes = 0
        done = 0
        try:
            while done < len(data):
                done += os.write(self._descriptor, data[done:])
        except OSError as error:
            self._cut_back(data[:done])
            raise LogError(
                f"{self.path}: {(error.strerror or 'cannot be written').lower()}; what is there is readable"
            ) from None
        self._digest.update(data)
        self._whole += done

    def close(self) -> None:
        """Flush and close; a second close does nothing."""
        if self._descriptor < 0:
            return
        try:
            self.flush()
        finally:
            os.close(self._descriptor)
            self._descriptor = -1

    def hexdigest(self) -> str:
        """SHA-256 of all that was flushed."""
        return self._digest.hexdigest()

    def _cut_back(self, partial: bytes) -> None:
        self._whole += partial.rfind(b"\n") + 1
        try:
            os.ftruncate(self._descriptor, self._whole)
        except OSError:
            return  # a device such as /dev/full cannot be cut
