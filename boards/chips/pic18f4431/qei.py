"""Quadrature encoder interface of the PIC18F4431 (DS39616D p. 165 f., hardware.md 3.5; mode numbers K)."""

from enum import IntEnum

from boards.chips.quadrature import Decoder

QERR, UP_DOWN = 0x40, 0x20
"""QEICON: a count was lost, direction."""
QEIM_SHIFT, QEIM_MASK = 2, 7
IC2QEIF, IC3DRIF = 0x04, 0x08
"""PIR3: position match, direction change."""


class Mode(IntEnum):
    """QEIM; any other value is off."""

    X2_INDEX = 0b001
    X2_MATCH = 0b010
    X4_INDEX = 0b101
    X4_MATCH = 0b110


X2 = (Mode.X2_INDEX, Mode.X2_MATCH)
BY_INDEX = (Mode.X2_INDEX, Mode.X4_INDEX)


class Qei4431:
    """qeicon, poscnt, maxcnt (16 bits), pir3: IC2QEIF and IC3DRIF, for firmware to clear."""

    def __init__(self) -> None:
        self.qeicon = UP_DOWN
        self.poscnt = 0
        self.maxcnt = 0xFFFF
        self.pir3 = 0
        self._decoder = Decoder()
        self._index = 0

    @property
    def mode(self) -> int:
        """QEIM."""
        return self.qeicon >> QEIM_SHIFT & QEIM_MASK

    def sample(self, a: int, b: int, index: int = 0) -> None:
        """New levels of QEA, QEB and INDX."""
        mode = self.mode
        if mode not in tuple(Mode):
            return
        step = self._decoder.edge(a, b, x2=mode in X2)
        if step is None:
            self.qeicon |= QERR
        if step:
            self._turn(step)
            self._count(mode, step)
        self._reset_by_index(mode, index)

    def _turn(self, step: int) -> None:
        if (step == 1) != bool(self.qeicon & UP_DOWN):
            self.qeicon ^= UP_DOWN
            self.pir3 |= IC3DRIF

    def _count(self, mode: int, step: int) -> None:
        """Up: MAXCNT is followed by 0; down: 0 by MAXCNT (by index: the counter just wraps)."""
        end, begin = (self.maxcnt, 0) if step == 1 else (0, self.maxcnt)
        if mode not in BY_INDEX and self.poscnt == end:
            self.poscnt = begin
            self.pir3 |= IC2QEIF
        else:
            self.poscnt = self.poscnt + step & 0xFFFF

    def _reset_by_index(self, mode: int, index: int) -> None:
        """Forward at the rising edge of INDX, reverse at its falling edge."""
        forward = bool(self.qeicon & UP_DOWN)
        rose, fell = index and not self._index, self._index and not index
        self._index = index
        if mode in BY_INDEX and (rose if forward else fell):
            self.poscnt = 0 if forward else self.maxcnt
            self.pir3 |= IC2QEIF
