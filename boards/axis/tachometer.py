"""Counts of the motors and of the auxiliary encoder brought to this board's sampling instants.

Their boards run on their own crystals, so their 10 ms slide past this board's. The count is carried on to the
moment of the sample. Carrying on needs a rate finer than the whole counts of one frame, so the differences go
through a low-pass of four frames (ASSUMPTION). Nothing here steers the axis.
"""

from typing import Final

from bus.protocol.motion import tach_fields

_FRAME_NS: Final = 10_000_000
"""Period of a TACH or ENCODER frame, ns (final.dbc)."""
_ROUTINE_NS: Final = 40_000
"""From the reading of the counter to the frame in the buffer of the motor board (its interrupt table)."""
MISSING_NS: Final = 25_000_000
"""Older data than two frames are not carried on."""
_RATE_SHIFT: Final = 8
"""Fraction bits of the rate, counts per frame."""
_UNIT: Final = _FRAME_NS << _RATE_SHIFT
_TURN: Final = 1 << 17
"""Counts of a turn, as the ENCODER frame carries them (final.dbc)."""
_AGE_UNIT_NS: Final = 4000
"""Unit of its age byte, ns (final.dbc)."""


class RemoteTachometer:
    """Keeps the last TACH frame of one motor. Times are those of the board's own clock, ns."""

    def __init__(self, frame_ns: int) -> None:
        self._age_ns = _ROUTINE_NS + frame_ns
        self._count = 0
        self.forget()

    def forget(self) -> None:
        """After power-up: nothing is known."""
        self._latch_ns = -2 * MISSING_NS
        self._rate_q8 = 0
        self._last: int | None = None

    def take(self, now_ns: int, data: bytes) -> None:
        """A TACH frame has come in."""
        _, _, self._count, delta = tach_fields(data)
        self._latch_ns = now_ns - self._age_ns
        self._rate_q8 += ((delta << _RATE_SHIFT) - self._rate_q8) >> 2

    def sample(self, now_ns: int) -> int:
        """Counts since the last sample, 10 ms ago: two carried counts' difference; 0: nothing to go by."""
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


class RemoteAuxiliary:
    """Keeps the last ENCODER frame of one axis. Times are those of the board's own clock, ns."""

    def __init__(self, frame_ns: int) -> None:
        self._frame_ns = frame_ns
        self._position = 0
        self.forget()

    def forget(self) -> None:
        """After power-up: nothing is known."""
        self._latch_ns = -2 * MISSING_NS  # the first frame may be older than this board
        self._rate_q8 = 0

    def take(self, now_ns: int, data: bytes) -> None:
        """An ENCODER frame has come in: bit 8 alarm, bits 16..32 position, byte 6 age in 4 us."""
        word = int.from_bytes(data, "little")
        if word >> 8 & 1:
            return  # the lamp is out: no position
        position = word >> 16 & (_TURN - 1)
        latch_ns = now_ns - self._frame_ns - (word >> 48 & 0xFF) * _AGE_UNIT_NS
        if latch_ns - self._latch_ns < MISSING_NS:
            moved = (position - self._position + _TURN // 2 & _TURN - 1) - _TURN // 2
            self._rate_q8 += ((moved << _RATE_SHIFT) - self._rate_q8) >> 2
        else:
            self._rate_q8 = 0
        self._position, self._latch_ns = position, latch_ns

    def sample(self, now_ns: int) -> int:
        """Position at `now_ns`, 17 bit; 0 while there is none."""
        age = now_ns - self._latch_ns
        if age > MISSING_NS:
            return 0
        return self._position + self._rate_q8 * age // _UNIT & _TURN - 1
