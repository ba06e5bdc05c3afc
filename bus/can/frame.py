"""A CAN 2.0 frame as the nodes see it."""

from typing import Final, final

MAX_STANDARD: Final = 0x7FF
MAX_EXTENDED: Final = 0x1FFF_FFFF
MAX_DATA_BYTES: Final = 8


class FrameError(ValueError):
    """A frame that CAN 2.0 cannot carry."""


@final
class Frame:
    """Identifier (11 bits, or 29 when `extended`), 0..8 data bytes, remote flag.

    A remote frame carries `data` only to state its length code; no byte of it goes over the wire.
    Not a tuple: compiled, its fields are read without a call, and there are a thousand frames a second with
    several readers each.
    """

    def __init__(self, identifier: int, data: bytes, extended: bool = False, remote: bool = False) -> None:
        self.identifier: Final = identifier
        self.data: Final = data
        self.extended: Final = extended
        self.remote: Final = remote

    def moved(self, identifier: int) -> "Frame":
        """The same frame with another identifier."""
        return Frame(identifier, self.data, self.extended, self.remote)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Frame) and (
            self.identifier == other.identifier
            and self.data == other.data
            and self.extended == other.extended
            and self.remote == other.remote
        )

    def __hash__(self) -> int:
        return hash((self.identifier, self.data, self.extended, self.remote))

    def __repr__(self) -> str:
        flags = (", extended" if self.extended else "") + (", remote" if self.remote else "")
        return f"Frame({self.identifier:#05x}, {self.data!r}{flags})"


def check(frame: Frame) -> None:
    """Raise FrameError unless CAN 2.0 can carry `frame`."""
    limit = MAX_EXTENDED if frame.extended else MAX_STANDARD
    if not 0 <= frame.identifier <= limit:
        raise FrameError(f"identifier {frame.identifier:#x} does not fit 0..{limit:#x}")
    if len(frame.data) > MAX_DATA_BYTES:
        raise FrameError(
            f"frame {frame.identifier:#x} has {len(frame.data)} data bytes, CAN carries at most 8"
        )


def arbitration_key(frame: Frame) -> int:
    """The arbitration field as one number, first bit highest: the lowest number wins the bus.

    Standard: 11 identifier bits, RTR, IDE = 0. Extended: 11 bits, SRR = 1, IDE = 1, 18 bits, RTR (ISO
    11898-1).
    """
    if not frame.extended:
        return frame.identifier << 21 | frame.remote << 20
    return frame.identifier >> 18 << 21 | 0b11 << 19 | (frame.identifier & 0x3FFFF) << 1 | frame.remote
