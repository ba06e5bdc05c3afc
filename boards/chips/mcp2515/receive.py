"""The receive buffers: masks and filters, roll-over, overflow (DS20001801 section 4, figure 4-3)."""

from boards.chips.mcp2515.message import (
    BUFFER_BYTES,
    DATA,
    DLC,
    EID0,
    EID8,
    EXIDE,
    RTR,
    SIDH,
    SIDL,
    SRR,
    image_of,
)
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
from bus.can import Frame

_MASK_OF = (0, 0, 1, 1, 1, 1)
FILTERS_OF = ((0, 1), (2, 3, 4, 5))
"""Filters of each receive buffer, the lowest wins."""
USE_FILTERS, STANDARD_ONLY, EXTENDED_ONLY, ANY = range(4)
"""RXM, bits 6:5 of RXBnCTRL. 01 and 10 as revisions E to G of the data sheet have them; revision J calls them
reserved."""


_FULL = (int(Interrupt.RX0), int(Interrupt.RX1))
_ROLLED = 6
"""FILHIT of a message that rolled over: 6 and 7 for filters 0 and 1."""


class Receiver:
    """Puts messages into the two buffers of `memory`; `full` has bits RX0IF and RX1IF of CANINTF."""

    def __init__(self, memory: bytearray) -> None:
        self._memory = memory

    def refilter(self) -> None:
        """Reset, or masks or filters were written, 4 bytes each (SIDH, SIDL, EID8, EID0)."""
        memory = self._memory
        self._masks = [bytes(memory[address : address + 4]) for address in MASK_ADDRESSES]
        self._filters = [bytes(memory[address : address + 4]) for address in FILTER_ADDRESSES]

    def take(self, frame: Frame, full: int) -> tuple[int, int]:
        """A good frame has arrived: (interrupt flags, overflow flags) it sets, (0, 0) if nobody wants it."""
        image = image_of(frame)
        hit = self._hit(image)
        if hit is None:
            return 0, 0
        buffer, code = hit
        if full & _FULL[buffer]:
            if buffer or not self._memory[RXBCTRL[0]] & BUKT:
                return 0, (RX0OVR, RX1OVR)[buffer]
            buffer, code = 1, _ROLLED + code
            if full & _FULL[1]:
                return 0, RX1OVR
        self._store(buffer, code, image)
        return _FULL[buffer], 0

    def _hit(self, image: bytes) -> tuple[int, int] | None:
        """The buffer that a message of 13 bytes goes to first, and the number of the filter that takes it.

        Under RXM = 11 that is the buffer's first filter (ASSUMPTION). None: nobody wants it.
        """
        extended = bool(image[SIDL] & EXIDE)
        for buffer, address in enumerate(RXBCTRL):
            mode = self._memory[address] >> 5 & 3
            if mode == ANY:
                return buffer, FILTERS_OF[buffer][0]
            if mode != (STANDARD_ONLY if extended else EXTENDED_ONLY):
                for number in FILTERS_OF[buffer]:
                    if self._takes(number, mode, image, extended):
                        return buffer, number
        return None

    def _takes(self, number: int, mode: int, image: bytes, extended: bool) -> bool:
        code, mask = self._filters[number], self._masks[_MASK_OF[number]]
        if bool(code[SIDL] & EXIDE) != extended:
            return False
        if (image[SIDH] ^ code[SIDH]) & mask[SIDH] or (image[SIDL] ^ code[SIDL]) & mask[SIDL] & 0xE0:
            return False
        if extended:
            high, low = image[EID8], image[EID0]
            if (image[SIDL] ^ code[SIDL]) & mask[SIDL] & 0x03:
                return False
        elif mode == USE_FILTERS:
            # the extended bytes of mask and filter look at the first two data bytes; absent ones count as 0
            high, low = image[DATA], image[DATA + 1]
        else:
            return True
        return not ((high ^ code[EID8]) & mask[EID8] or (low ^ code[EID0]) & mask[EID0])

    def _store(self, buffer: int, code: int, image: bytes) -> None:
        memory = self._memory
        address = RXBCTRL[buffer]
        memory[address + 1 : address + 1 + BUFFER_BYTES] = image
        remote = RXRTR if image[DLC] & RTR else 0
        memory[address] = memory[address] & (0x60 if buffer else 0x66) | remote | code

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
