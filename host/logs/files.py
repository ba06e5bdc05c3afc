"""Files that grow, plain or through zstd, and stay readable whatever happens to the disk."""

import hashlib
import os
import re
import shutil
from datetime import datetime
from pathlib import Path
from typing import Final

_BUFFER_BYTES: Final = 1 << 16


class LogError(ValueError):
    """A log cannot be written; the message says which and why."""


def write_file(path: Path, data: str | bytes) -> None:
    """Write a whole file, text as UTF-8, and its folder if need be; raises `LogError` that names it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(data.encode() if isinstance(data, str) else data)
    except OSError as error:
        raise LogError(f"{path}: cannot be written: {reason(error)}") from None


class BlockFile:
    """Blocks of whole lines to a file, unbuffered.

    When the disk fills up in the middle of a line, the file is cut back to its last whole line. Where blocks
    are not lines, it is cut back to its last whole block. After a failure it takes nothing more.
    """

    def __init__(self, path: Path, lines: bool = True) -> None:
        self.path = path
        self._lines = lines
        self._whole = 0  # bytes up to the last whole line on disk
        try:
            self._descriptor = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o644)
        except OSError as error:
            raise LogError(f"{path}: cannot be written: {reason(error)}") from None

    def write(self, data: bytes) -> int:
        """Write a block; raises `LogError` when it does not fit."""
        done = 0
        try:
            while self._descriptor >= 0 and done < len(data):
                done += os.write(self._descriptor, data[done:])
        except OSError as error:
            self._cut_back(data[:done])
            raise LogError(f"{self.path}: {reason(error)}; what is there is readable") from None
        self._whole += done
        return done

    def flush(self) -> None:
        """Nothing is kept back."""

    def close(self) -> None:
        """Close; a second close does nothing."""
        if self._descriptor >= 0:
            os.close(self._descriptor)
            self._descriptor = -1

    def _cut_back(self, partial: bytes) -> None:
        if self._lines:
            self._whole += partial.rfind(b"\n") + 1
        try:
            os.ftruncate(self._descriptor, self._whole)
        except OSError:
            pass  # a device such as /dev/full cannot be cut
        finally:
            self.close()


class LineFile:
    """Lines to a file, buffered, with a running SHA-256 of what was written."""

    def __init__(self, path: Path, buffer_bytes: int = _BUFFER_BYTES) -> None:
        self.path = path
        self.lines = 0
        self._file = BlockFile(path)
        self._digest = hashlib.sha256()
        self._waiting: list[str] = []
        self._waiting_bytes = 0
        self._limit = buffer_bytes

    def write(self, text: str) -> None:
        """Append whole lines (`text` ends with a newline)."""
        self._waiting.append(text)
        self._waiting_bytes += len(text)
        self.lines += 1
        if self._waiting_bytes >= self._limit:
            self.flush()

    def flush(self) -> None:
        """Bring everything to the operating system; raises `LogError` when it does not fit."""
        if not self._waiting:
            return
        data = "".join(self._waiting).encode()
        self._waiting.clear()
        self._waiting_bytes = 0
        self._file.write(data)
        self._digest.update(data)

    def close(self) -> None:
        """Flush and close; a second close does nothing."""
        try:
            self.flush()
        finally:
            self._file.close()

    def reopen(self) -> None:
        """Begin an empty file in the place of the one that was closed; the digest goes on."""
        self._file = BlockFile(self.path)

    def hexdigest(self) -> str:
        """SHA-256 of all that was flushed."""
        return self._digest.hexdigest()


def reason(error: Exception) -> str:
    """The reason that the system gives, in one line, without its number."""
    said = re.sub(r"\[Errno -?\d+\] ", "", getattr(error, "strerror", None) or str(error))
    first = (said.splitlines() or [type(error).__name__])[0]
    return first[:1].lower() + first[1:]


RESERVE_BYTES = 8 << 20
"""Enough for the buffers of all logs, a row group of every trace and the summary."""


def check_space(folder: Path, reserve_bytes: int = RESERVE_BYTES) -> None:
    """Raise `LogError` when the disk under `folder` is about to be full."""
    free = shutil.disk_usage(folder).free
    if free < reserve_bytes:
        raise LogError(
            f"{folder}: no space left on the disk ({free >> 20} MiB free); logs end here, readable"
        )


_PIECE_BYTES: Final = 1 << 20
"""Enough that a frame's head and an empty window do not show. A run flushes about every 400 kB."""
LEVEL: Final = 1
"""The log of a short night shrinks to a seventh (987 to 143 kB)."""


class ZstdFile(BlockFile):
    """As a `BlockFile`; raises `LogError` like one. What is written waits for `flush` or the piece's end.

    Each piece is a zstd frame of its own, so that what is there unpacks whatever happens. Programs such as
    zstdcat, and pyarrow, read the frames of a file as one.
    """

    def __init__(self, path: Path) -> None:
        import pyarrow

        super().__init__(path, lines=False)
        self._codec = pyarrow.Codec("zstd", compression_level=LEVEL)
        self._waiting = bytearray()

    def write(self, data: bytes) -> int:
        """Take a block."""
        self._waiting += data
        if len(self._waiting) >= _PIECE_BYTES:
            self.flush()
        return len(data)

    def flush(self) -> None:
        """Write what waits as a frame of its own."""
        if self._waiting:
            data = bytes(self._waiting)
            self._waiting.clear()
            super().write(self._codec.compress(data, asbytes=True))

    def close(self) -> None:
        """Flush and close; a second close does nothing."""
        try:
            self.flush()
        finally:
            super().close()


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
