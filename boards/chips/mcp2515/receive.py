"""The receive buffers: acceptance, roll-over, overflow (DS20001801 section 4, figure 4-3)."""

from boards.chips.mcp2515.registers import (
    BUKT,
    FILTER_ADDRESSES,
    MASK_ADDRESSES,
    RX0OVR,
    RX1OVR,
    RXBCTRL,
    RXRTR,
    Interrupt,
)
from boards.chips.microchip_can.acceptance import Acceptance
from boards.chips.microchip_can.message import BUFFER_BYTES, DLC, EXIDE, RTR, SIDL, SRR, image_of
from bus.can import Frame

_FULL = (int(Interrupt.RX0), int(Interrupt.RX1))
_ROLLED = 6
"""FILHIT of a message that rolled over: 6 and 7 for filters 0 and 1."""


class Receiver:
    """Puts messages into the two buffers of `memory`; `full` has bits RX0IF and RX1IF of CANINTF."""

    def __init__(self, memory: bytearray) -> None:
        self._memory = memory
        self.acceptance = Acceptance()

    def refilter(self) -> None:
        """Masks or filters were written."""
        memory = self._memory
        self.acceptance.masks = [bytes(memory[address : address + 4]) for address in MASK_ADDRESSES]
        self.acceptance.filters = [bytes(memory[address : address + 4]) for address in FILTER_ADDRESSES]

    def take(self, frame: Frame, full: int) -> tuple[int, int]:
        """A good frame has arrived: (interrupt flags, overflow flags) it sets, (0, 0) when nobody
        wants it."""
        image = image_of(frame)
        control = self._memory[RXBCTRL[0]]
        hit = self.acceptance.hit(image, (control >> 5 & 3, self._memory[RXBCTRL[1]] >> 5 & 3))
        if hit is None:
            return 0, 0
        buffer, code = hit
        if full & _FULL[buffer]:
            if buffer or not control & BUKT:
                return 0, (RX0OVR, RX1OVR)[buffer]
            buffer, code = 1, _ROLLED + code
            if full & _FULL[1]:
                return 0, RX1OVR
        self._store(buffer, code, image)
        return _FULL[buffer], 0

    def _store(self, buffer: int, code: int, image: bytes) -> None:
        memory = self._memory
        address = RXBCTRL[buffer]
        memory[address + 1 : address + 1 + BUFFER_BYTES] = image
        remote = RXRTR if image[DLC] & RTR else 0
        if buffer:
            memory[address] = memory[address] & 0x60 | remote | code
        else:
            memory[address] = memory[address] & 0x66 | remote | code

    def status(self, full: int) -> int:
        """Answer to RX STATUS (DS20001801 figure 12-9); buffer 0 goes first."""
        full &= 3
        if not full:
            return 0
        address = RXBCTRL[0] if full & 1 else RXBCTRL[1]
        memory = self._memory
        extended = memory[address + 1 + SIDL] & EXIDE
        remote = memory[address + 1 + DLC] & RTR if extended else memory[address + 1 + SIDL] & SRR
        code = memory[address] & (1 if full & 1 else 7)
        return full << 6 | (0x10 if extended else 0) | (0x08 if remote else 0) | code
