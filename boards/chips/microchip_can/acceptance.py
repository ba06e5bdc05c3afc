"""Two masks, six filters (DS20001801 section 4.5): filters 0, 1 lead to buffer 0, 2..5 to buffer 1."""

from typing import NamedTuple

from boards.chips.microchip_can.message import DATA, EID0, EID8, EXIDE, SIDH, SIDL

_MASK_OF = (0, 0, 1, 1, 1, 1)
FILTERS_OF = ((0, 1), (2, 3, 4, 5))
"""Filters of each receive buffer, the lowest wins."""
USE_FILTERS, STANDARD_ONLY, EXTENDED_ONLY, ANY = range(4)
"""RXM, bits 6:5 of RXBnCTRL. 01 and 10 as revisions E to G of the data sheet have them; revision J calls them
reserved."""


class Hit(NamedTuple):
    """A message is for a buffer: which one, and the number of the filter that took it (under RXM = 11 the
    buffer's first, ASSUMPTION)."""

    buffer: int
    filter: int


class Acceptance:
    """Masks and filters as their registers have them: 4 bytes each (SIDH, SIDL, EID8, EID0)."""

    def __init__(self) -> None:
        self.masks = [bytes(4), bytes(4)]
        self.filters = [bytes(4)] * 6

    def hit(self, image: bytes, modes: tuple[int, int]) -> Hit | None:
        """Where the message of 13 bytes `image` goes first, given RXM of both buffers; None: nowhere."""
        for buffer, mode in enumerate(modes):
            number = self._match(buffer, mode, image)
            if number is not None:
                return Hit(buffer, number)
        return None

    def _match(self, buffer: int, mode: int, image: bytes) -> int | None:
        extended = bool(image[SIDL] & EXIDE)
        if mode == ANY:
            return FILTERS_OF[buffer][0]
        if (mode == STANDARD_ONLY and extended) or (mode == EXTENDED_ONLY and not extended):
            return None
        for number in FILTERS_OF[buffer]:
            if self._takes(number, mode, image, extended):
                return number
        return None

    def _takes(self, number: int, mode: int, image: bytes, extended: bool) -> bool:
        code, mask = self.filters[number], self.masks[_MASK_OF[number]]
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
