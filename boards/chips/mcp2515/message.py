"""A message buffer: identifier, length code, data in 13 bytes (DS20001801, registers 3-3..3-8, 4-4..4-9)."""

from bus.can import Frame

SIDH, SIDL, EID8, EID0, DLC, DATA = range(6)
BUFFER_BYTES = 13
EXIDE = 0x08
"""SIDL: extended identifier (IDE of a received message)."""
SRR = 0x10
"""SIDL of a received standard message: it is a remote frame."""
RTR = 0x40
"""DLC: remote frame."""
_MAX_BYTES = 8


def identifier_of(four: bytes | bytearray) -> tuple[int, bool]:
    """Identifier and whether it is extended, from SIDH, SIDL, EID8, EID0."""
    standard = four[SIDH] << 3 | four[SIDL] >> 5
    if not four[SIDL] & EXIDE:
        return standard, False
    return standard << 18 | (four[SIDL] & 3) << 16 | four[EID8] << 8 | four[EID0], True


def identifier_image(identifier: int, extended: bool) -> bytes:
    """SIDH, SIDL, EID8, EID0 of an identifier; the inverse of `identifier_of`."""
    if not extended:
        return bytes((identifier >> 3, (identifier & 7) << 5, 0, 0))
    standard, rest = identifier >> 18, identifier & 0x3FFFF
    return bytes((standard >> 3, (standard & 7) << 5 | EXIDE | rest >> 16, rest >> 8 & 0xFF, rest & 0xFF))


def frame_of(image: bytes | bytearray) -> Frame:
    """The frame that a transmit buffer of 13 bytes sends. A length code above 8 sends eight bytes.

    A remote frame takes its data from the buffer too; only their number goes over the wire.
    """
    identifier, extended = identifier_of(image)
    length = min(image[DLC] & 0x0F, _MAX_BYTES)
    remote = bool(image[DLC] & RTR)
    data = bytes(length) if remote else bytes(image[DATA : DATA + length])
    return Frame(identifier, data, extended, remote)


def image_of(frame: Frame) -> bytes:
    """The 13 bytes of a receive buffer that holds `frame`; bytes beyond its data are 0 (ASSUMPTION: a chip
    leaves there what was in them).

    A remote frame sets SRR (standard) and RTR in DLC: drivers differ in which one they look at.
    """
    head = bytearray(identifier_image(frame.identifier, frame.extended))
    length = len(frame.data)
    if frame.remote:
        if not frame.extended:
            head[SIDL] |= SRR
        return bytes(head) + bytes((length | RTR,)) + bytes(_MAX_BYTES)
    return bytes(head) + bytes((length,)) + frame.data + bytes(_MAX_BYTES - length)
