"""Logs in the format of `candump -L`: `(1.000129) can0 211#1101000000000000`, times since the start or an
epoch."""

import re
from array import array
from hashlib import sha256
from typing import BinaryIO, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from bus.can.frame import Frame

_BATCH: Final = 1024
Whole = NDArray[np.int64]
Columns = NDArray[np.void]
_THREE: Final = np.dtype("V3")
_DECIMAL: Final[Columns] = np.frombuffer(b"".join(b"%03d" % k for k in range(1000)), _THREE)
"""Three digits of every number below 1000."""
_HEXADECIMAL: Final[Columns] = np.frombuffer(b"".join(b"%03X" % k for k in range(2048)), _THREE)
"""Every standard identifier."""
_US_PER_S: Final = 1_000_000
_BYTES: Final = 8


_LINE: Final = re.compile(
    r"\((\d{1,10})\.(\d{6})\) \S+ ([0-7][0-9A-F]{2}|[0-3][0-9A-F]{7})#(?:R([0-8]?)|((?:[0-9A-F]{2}){0,8}))"
)
"""candump writes a remote frame of no bytes as `R`."""


class _Digest(Protocol):
    def update(self, data: bytes, /) -> None: ...
    def hexdigest(self) -> str: ...


def line(t_ns: int, frame: Frame) -> str:
    """One line without its end; the time is cut to microseconds as candump has it."""
    us = t_ns // 1000
    name = "%08X" if frame.extended else "%03X"
    body = f"R{len(frame.data)}" if frame.remote else frame.data.hex().upper()
    parts = (us // _US_PER_S, us % _US_PER_S, name % frame.identifier, body)
    return "(%d.%06d) can0 %s#%s" % parts  # noqa: UP031  mypyc calls format() for every f-string with a width


def parsed(text: str) -> tuple[int, Frame] | None:
    """Time, ns, and frame of such a line; None: it is none. An error frame has bit 29 of its identifier set
    (CAN_ERR_FLAG, linux/can.h)."""
    found = _LINE.fullmatch(text)
    if found is None:
        return None
    seconds, micros, name, length, data = found.groups()
    body = bytes(int(length or 0)) if length is not None else bytes.fromhex(data)
    frame = Frame(int(name, 16), body, len(name) == 8, length is not None)
    return int(seconds) * 1_000_000_000 + int(micros) * 1000, frame


def block(times_ns: list[int], frames: list[Frame]) -> bytes:
    """The lines of many frames. Eight-byte frames of standard identifiers, as nearly all of a night are, make
    lines of one length: those are filled in column by column."""
    if not frames:
        return b""
    plain = all(len(frame.data) == _BYTES and not frame.extended and not frame.remote for frame in frames)
    us = np.frombuffer(array("q", times_ns), np.int64) // 1000
    seconds = us // _US_PER_S  # np.divmod takes ten times as long
    width = len(str(seconds.max()))
    if not plain or len(str(seconds.min())) != width:
        lines = [line(t_ns, frame) + "\n" for t_ns, frame in zip(times_ns, frames, strict=True)]
        return "".join(lines).encode()
    identifiers = np.frombuffer(array("q", [frame.identifier for frame in frames]), np.int64)
    data = b"".join([frame.data for frame in frames]).hex().upper().encode()
    return _columns(seconds, us - seconds * _US_PER_S, identifiers, data)


def _columns(seconds: Whole, us: Whole, identifiers: Whole, data: bytes) -> bytes:
    """Lines of one length. seconds: all of as many digits. us: within the second. data: 16 hexadecimal digits
    per frame."""
    head, middle = f"({seconds[0]}.".encode(), b") can0 "
    line = np.dtype(
        [("head", f"V{len(head)}"), ("ms", "V3"), ("us", "V3"), ("middle", f"V{len(middle)}"), ("id", "V3"),
         ("hash", "V1"), ("data", f"V{2 * _BYTES}"), ("end", "V1")]
    )  # fmt: skip
    lines = np.empty(len(seconds), line)
    for name, text in (("head", head), ("middle", middle), ("hash", b"#"), ("end", b"\n")):
        lines[name] = np.void(text)
    if np.ptp(seconds):
        for second in sorted(set(seconds.tolist())):  # np.unique would import numpy.ma, 30 ms at a tick
            lines["head"][seconds == second] = np.void(f"({second}.".encode())
    ms = us // 1000
    lines["ms"] = _DECIMAL[ms]
    lines["us"] = _DECIMAL[us - ms * 1000]
    lines["id"] = _HEXADECIMAL[identifiers]
    lines["data"] = np.frombuffer(data, line["data"])
    return lines.tobytes()


class CandumpWriter:
    """Writes a log and keeps its SHA-256; `take` is a tap for `Wire.tap`.

    file: binary, or None to keep the digest only.
    Frames are written in batches of 1024: `flush()` (or `close()`) for the rest.
    """

    def __init__(self, file: BinaryIO | None) -> None:
        self.frames = 0
        self._file = file
        self._digest: _Digest = sha256()
        self._times_ns: list[int] = []
        self._waiting: list[Frame] = []

    def take(self, t_ns: int, frame: Frame, _sender: str = "") -> None:
        """Take one frame."""
        self._times_ns.append(t_ns)
        waiting = self._waiting
        waiting.append(frame)
        if len(waiting) >= _BATCH:
            self._write()

    def _write(self) -> None:
        text = block(self._times_ns, self._waiting)
        self._digest.update(text)
        if self._file is not None:
            self._file.write(text)
        self.frames += len(self._waiting)
        self._times_ns.clear()
        self._waiting.clear()

    def resume(self, text: bytes) -> None:
        """Begin with whole lines that were written before."""
        self._digest.update(text)
        if self._file is not None:
            self._file.write(text)
        self.frames += text.count(b"\n")

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
