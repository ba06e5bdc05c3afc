"""Logs in the format of `candump -L`: `(1.000129) can0 211#1101000000000000`, times since the start or an
epoch."""

from hashlib import sha256
from typing import BinaryIO, Protocol

from bus.can.frame import Frame

_BATCH = 1024
_SECOND_NS = 1_000_000_000


class _Digest(Protocol):
    def update(self, data: bytes, /) -> None: ...
    def hexdigest(self) -> str: ...


def line(t_ns: int, frame: Frame, channel: str = "can0") -> str:
    """One line without its end; the time is cut to microseconds as candump has it."""
    identifier, data, extended, remote = frame
    name = f"{identifier:08X}" if extended else f"{identifier:03X}"
    body = f"R{len(data)}" if remote else data.hex().upper()
    return f"({t_ns // 1_000_000_000}.{t_ns // 1000 % 1_000_000:06d}) {channel} {name}#{body}"


class CandumpWriter:
    """A tap for `Wire.tap` that writes a log and keeps its SHA-256.

    file: binary, or None to keep the digest only. epoch_s: added to every time (0: times since the start).
    Frames are written in batches of 1024: `flush()` (or `close()`) for the rest.
    """

    def __init__(self, file: BinaryIO | None, channel: str = "can0", epoch_s: int = 0) -> None:
        self.frames = 0
        self._file = file
        self._channel = channel
        self._epoch_ns = epoch_s * 1_000_000_000
        self._digest: _Digest = sha256()
        self._batch: list[tuple[int, Frame]] = []
        self._names: dict[int, str] = {}
        """Channel and identifier as they are printed, per standard identifier."""

    def take(self, t_ns: int, frame: Frame, _sender: str = "") -> None:
        """Take one frame."""
        batch = self._batch
        batch.append((t_ns, frame))
        if len(batch) >= _BATCH:
            self._write()

    __call__ = take

    def _write(self) -> None:
        epoch_ns, channel = self._epoch_ns, self._channel
        lines = []
        names = self._names
        for t_ns, frame in self._batch:
            t_ns += epoch_ns
            identifier, data, extended, remote = frame
            if extended or remote or t_ns < _SECOND_NS:
                lines.append(line(t_ns, frame, channel) + "\n")
                continue
            # Pieces of text where they will do: this is done for every frame of a night.
            if identifier not in names:
                names[identifier] = f"{channel} {identifier:03X}"
            time_us = str(t_ns // 1000)
            lines.append(f"({time_us[:-6]}.{time_us[-6:]}) {names[identifier]}#{data.hex().upper()}\n")
        block = "".join(lines).encode()
        self._digest.update(block)
        if self._file is not None:
            self._file.write(block)
        self.frames += len(self._batch)
        self._batch.clear()

    def flush(self) -> None:
        """Write what has been taken so far through to the file."""
        self._write()
        if self._file is not None:
            self._file.flush()

    def close(self) -> None:
        """Flush; the file stays the caller's."""
        self.flush()

    def hexdigest(self) -> str:
        """SHA-256 of everything written so far, taken frames included."""
        self._write()
        return self._digest.hexdigest()
