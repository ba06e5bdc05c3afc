"""The auxiliary encoder's reading brought to this board's sampling instants, for the axis log.

The encoder's board runs on its own crystal, so its 10 ms slide past this board's. The last position is
carried on by a low-pass of the frames' differences, as the motors' counts are. Nothing here steers the axis.
"""

from typing import Final

from boards.axis.tachometer import MISSING_NS

_TURN: Final = 1 << 17
"""Counts of a turn, as the ENCODER frame carries them (final.dbc)."""
_FRAME_NS: Final = 10_000_000
"""Period of that frame, ns (final.dbc)."""
_AGE_UNIT_NS: Final = 4000
"""Unit of its age byte, ns (final.dbc)."""
_RATE_SHIFT: Final = 8
"""Fraction bits of the rate, counts per frame; with the low-pass over four frames: ASSUMPTION."""
_UNIT: Final = _FRAME_NS << _RATE_SHIFT


class RemoteAuxiliary:
    """Keeps the last ENCODER frame of one axis. Times are those of the board's own clock, ns."""

    def __init__(self, frame_ns: int) -> None:
        self._frame_ns = frame_ns
        self._latch_ns = -MISSING_NS
        self._position = 0
        self._rate_q8 = 0

    def forget(self) -> None:
        """After power-up: nothing is known."""
        self._latch_ns = -MISSING_NS
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
