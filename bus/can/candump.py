"""Logs in the format of `candump -L`: `(1.000129) can0 211#1101000000000000`, times since the start or an
epoch."""

from hashlib import sha256
from typing import BinaryIO, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from bus.can.frame import Frame

_BATCH: Final = 1024
_HEX: Final = np.frombuffer(b"0123456789ABCDEF", np.uint8)
_ZERO: Final = ord("0")
_BYTES: Final = 8


class _Digest(Protocol):
    def update(self, data: bytes, /) -> None: ...
    def hexdigest(self) -> str: ...


def line(t_ns: int, frame: Frame, channel: str = "can0") -> str:
    """One line without its end; the time is cut to microseconds as candump has it."""
    identifier, data, extended, remote = frame
    name = f"{identifier:08X}" if extended else f"{identifier:03X}"
    body = f"R{len(data)}" if remote else data.hex().upper()
    return f"({t_ns // 1_000_000_000}.{t_ns // 1000 % 1_000_000:06d}) {channel} {name}#{body}"


def block(times_ns: list[int], frames: list[Frame], channel: str = "can0") -> bytes:
    """The lines of many frames. Eight-byte frames of standard identifiers, as nearly all of a night are, make
    lines of one length: those are filled in column by column."""
    plain = all(len(frame[1]) == _BYTES and not frame[2] and not frame[3] for frame in frames)
    width = len(str(max(times_ns, default=0) // 1000))
    if not plain or width < 7 or len(str(min(times_ns) // 1000)) != width:
        lines = [line(t_ns, frame, channel) + "\n" for t_ns, frame in zip(times_ns, frames, strict=True)]
        return "".join(lines).encode()
    return _columns(
        np.array(times_ns) // 1000,
        width,
        np.array([frame[0] for frame in frames]),
        np.frombuffer(b"".join([frame[1] for frame in frames]), np.uint8).reshape(-1, _BYTES),
        channel,
    )


def _columns(
    time_us: NDArray[np.int64],
    width: int,
    identifiers: NDArray[np.int64],
    data: NDArray[np.uint8],
    channel: str,
) -> bytes:
    """Lines of one length. width: digits of `time_us` (n,). data: (n, 8)."""
    template = f"({'0' * (width - 6)}.000000) {channel} 000#{'00' * _BYTES}\n".encode()
    lines = np.tile(np.frombuffer(template, np.uint8), (len(data), 1))
    digits = time_us[:, None] // 10 ** np.arange(width - 1, -1, -1) % 10 + _ZERO
    lines[:, 1 : width - 5] = digits[:, : width - 6]
    lines[:, width - 4 : width + 2] = digits[:, width - 6 :]
    body = len(template) - 1 - 2 * _BYTES
    lines[:, body:-1:2] = _HEX[data >> 4]
    lines[:, body + 1 : -1 : 2] = _HEX[data & 15]
    lines[:, body - 4 : body - 1] = _HEX[identifiers[:, None] >> np.array([8, 4, 0]) & 15]
    return lines.tobytes()


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
        self._times_ns: list[int] = []
        self._waiting: list[Frame] = []

    def take(self, t_ns: int, frame: Frame, _sender: str = "") -> None:
        """Take one frame."""
        self._times_ns.append(t_ns + self._epoch_ns)
        waiting = self._waiting
        waiting.append(frame)
        if len(waiting) >= _BATCH:
            self._write()

    def __call__(self, t_ns: int, frame: Frame, sender: str = "") -> None:
        """The same, so that a writer itself can be a tap."""
        self.take(t_ns, frame, sender)

    def _write(self) -> None:
        text = block(self._times_ns, self._waiting, self._channel)
        self._digest.update(text)
        if self._file is not None:
            self._file.write(text)
        self.frames += len(self._waiting)
        self._times_ns.clear()
        self._waiting.clear()

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
