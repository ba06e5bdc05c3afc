"""Text through zstd to a file: one zstd frame per piece, so that what is there unpacks whatever happens.

Level 1: the log of a short night shrinks to a seventh (987 to 143 kB).
Programs such as zstdcat, and pyarrow, read the frames of a file as one.
"""

from pathlib import Path
from typing import Final

from host.logs.files import BlockFile

_PIECE_BYTES: Final = 1 << 20
"""Enough that a frame's head and an empty window do not show. A run flushes about every 400 kB."""
LEVEL: Final = 1


class ZstdFile:
    """As a `BlockFile`; raises `LogError` like one. What is written waits for `flush` or the piece's end."""

    def __init__(self, path: Path) -> None:
        import pyarrow

        self._file = BlockFile(path, lines=False)
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
            self._file.write(self._codec.compress(data, asbytes=True))

    def close(self) -> None:
        """Flush and close; a second close does nothing."""
        try:
            self.flush()
        finally:
            self._file.close()
