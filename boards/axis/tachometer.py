"""A motor board's counts brought to this board's sampling instants.

Both boards run on their own crystals, so their 10 ms slide past each other: the count is carried on
with the last difference to the moment of the sample, and the sample is the difference of two such counts.
"""

from bus.protocol import unpack_tach

_TACH_NS = 10_000_000
_ROUTINE_NS = 40_000
"""From the reading of the counter to the frame in the buffer of the motor board (its interrupt table)."""
_MISSING_NS = 25_000_000
"""Older data than two frames are not carried on."""


class RemoteTachometer:
    """Keeps the last TACH frame of one motor."""

    __slots__ = ("_age_ns", "_data", "_last", "_received_ns")

    def __init__(self, frame_ns: int) -> None:
        self._age_ns = _ROUTINE_NS + frame_ns
        self._data: bytes | None = None
        self._received_ns = 0
        self._last: int | None = None

    def take(self, t_ns: int, data: bytes) -> None:
        """A TACH frame has come in."""
        self._data = data
        self._received_ns = t_ns

    def sample(self, t_ns: int) -> int:
        """Counts since the last sample, 10 ms ago; 0 while there is nothing to go by."""
        data = self._data
        if data is None:
            return 0
        age = t_ns - self._received_ns + self._age_ns
        if age > _MISSING_NS:
            self._last = None
            return 0
        _, _, count, delta = unpack_tach(data)
        now = count + delta * age // _TACH_NS
        last = self._last
        self._last = now
        if last is None:
            return delta
        return (now - last + 0x8000_0000 & 0xFFFF_FFFF) - 0x8000_0000
