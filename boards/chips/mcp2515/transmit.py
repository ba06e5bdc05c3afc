"""The transmit buffers: priority, abort, one shot (DS20001801 section 3)."""

from collections.abc import Callable
from typing import NamedTuple

from boards.chips.mcp2515.message import BUFFER_BYTES, frame_of
from boards.chips.mcp2515.registers import ABAT, ABTF, CANCTRL, MLOA, OSM, TXBCTRL, TXERR, TXP, TXREQ
from bus.can import Frame


class Outgoing(NamedTuple):
    """What the chip has offered to the bus."""

    buffer: int
    frame: Frame


class Transmitter:
    """Chooses among the three buffers of `memory` and offers one frame at a time.

    offer: puts a frame on the bus when it is free. withdraw: takes it back, False when it has begun.
    """

    def __init__(
        self, memory: bytearray, offer: Callable[[Frame], None], withdraw: Callable[[Frame], bool]
    ) -> None:
        self._memory = memory
        self._offer = offer
        self._withdraw = withdraw
        self.current: Outgoing | None = None
        self.on_bus = False

    def forget(self) -> None:
        """The bus side is off: nothing is offered any more."""
        self.current = None
        self.on_bus = False

    @property
    def pending(self) -> bool:
        """Whether any buffer waits, or is on the bus."""
        return self.on_bus or any(self._memory[address] & TXREQ for address in TXBCTRL)

    def best(self) -> int | None:
        """Buffer that goes next: highest TXP, among equals the highest number."""
        memory = self._memory
        waiting = [n for n in range(3) if memory[TXBCTRL[n]] & TXREQ]
        return max(waiting, key=lambda n: (memory[TXBCTRL[n]] & TXP, n), default=None)

    def frame(self, buffer: int) -> Frame:
        """What a buffer holds."""
        start = TXBCTRL[buffer] + 1
        return frame_of(self._memory[start : start + BUFFER_BYTES])

    def pump(self) -> None:
        """Offer the best buffer, unless one is on the bus."""
        if self.on_bus:
            return
        best = self.best()
        current = self.current
        if current is not None:
            if current.buffer == best:
                return
            if not self._withdraw(current.frame):
                self.on_bus = True
                return
            self.current = None
        if best is not None:
            self.current = Outgoing(best, self.frame(best))
            self._offer(self.current.frame)

    def take(self, buffer: int, frame: Frame) -> Outgoing:
        """`buffer` is being sent without the bus (loop-back); it is `current` until it is through."""
        self.current = Outgoing(buffer, frame)
        self.on_bus = True
        return self.current

    def control(self, buffer: int, value: int) -> None:
        """TXBnCTRL is written: a new request clears what became of the last one."""
        address = TXBCTRL[buffer]
        old = self._memory[address]
        status = old & (ABTF | MLOA | TXERR)
        if value & TXREQ and not old & TXREQ:
            status = 0
        self._memory[address] = status | value & (TXREQ | TXP)
        if self._memory[CANCTRL] & ABAT:
            self.abort_all()

    def abort_all(self) -> None:
        """ABAT: every request is taken back and marked; the one on the bus is only when it fails."""
        for buffer, address in enumerate(TXBCTRL):
            if self.on_bus and self.current is not None and self.current.buffer == buffer:
                continue
            if self._memory[address] & TXREQ:
                self._memory[address] = self._memory[address] & ~TXREQ | ABTF

    def sent(self) -> int | None:
        """The frame on the bus is through: its buffer, free again."""
        current, self.current, self.on_bus = self.current, None, False
        if current is None:
            return None
        self._memory[TXBCTRL[current.buffer]] &= ~TXREQ & 0xFF
        return current.buffer

    def missed(self, mark: int) -> None:
        """The attempt failed: lost arbitration (MLOA) or an error (TXERR). Another one follows unless the
        request was taken back, all are to be aborted, or there is one shot only."""
        self.on_bus = False
        current = self.current
        if current is None:
            return
        address = TXBCTRL[current.buffer]
        control = self._memory[CANCTRL]
        value = self._memory[address] | mark
        if value & TXREQ and control & ABAT:
            value = value & ~TXREQ | ABTF
        elif control & OSM:
            value &= ~TXREQ
        self._memory[address] = value
        self.pump()
