"""A motor board's counts brought to this board's sampling instants.

Both boards run on their own crystals, so their 10 ms slide past each other. The count is carried on to the
moment of the sample, and the sample is the difference of two such counts. Carrying on needs a
rate finer than the whole counts of one frame, so the differences go through a low-pass of four frames.
"""

from typing import Final

from bus.protocol.tach import tach_fields

_TACH_NS: Final = 10_000_000
_ROUTINE_NS: Final = 40_000
"""From the reading of the counter to the frame in the buffer of the motor board (its interrupt table)."""
MISSING_NS: Final = 25_000_000
"""Older data than two frames are not carried on."""
_RATE_SHIFT: Final = 8
_UNIT: Final = _TACH_NS << _RATE_SHIFT


class RemoteTachometer:
    """Keeps the last TACH frame of one motor. Times are those of the board's own clock."""

    def __init__(self, frame_ns: int) -> None:
        self._age_ns = _ROUTINE_NS + frame_ns
        self._latch_ns = -MISSING_NS
        self._count = 0
        self._rate_q8 = 0
        self._last: int | None = None

    def forget(self) -> None:
        """After power-up: nothing is known."""
        self._latch_ns = -MISSING_NS
        self._last = None
        self._rate_q8 = 0

    def take(self, now_ns: int, data: bytes) -> None:
        """A TACH frame has come in."""
        _, _, self._count, delta = tach_fields(data)
        self._latch_ns = now_ns - self._age_ns
        self._rate_q8 += ((delta << _RATE_SHIFT) - self._rate_q8) >> 2

    def sample(self, now_ns: int) -> int:
        """Counts since the last sample, 10 ms ago; 0 while there is nothing to go by."""
        age = now_ns - self._latch_ns
        if age > MISSING_NS:
            self._last = None
            return 0
        now = self._count + self._rate_q8 * age // _UNIT
        last = self._last
        self._last = now
        if last is None:
            return self._rate_q8 >> _RATE_SHIFT
        return (now - last + 0x8000_0000 & 0xFFFF_FFFF) - 0x8000_0000
