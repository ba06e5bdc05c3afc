"""What one disturbed bit does to a frame: which error it becomes, where it is detected, who got the frame."""

from typing import Literal, NamedTuple

from bus.can.bits import TAIL_BITS, crc15, header_bits, stuff, stuffed_field
from bus.can.frame import Frame

ErrorKind = Literal["bit", "stuff", "form", "crc", "ack"]
SenderCounts = Literal["transmits", "lost", "spared"]
"""How an error counts at the node that had begun the frame (ISO 11898-1, fault confinement).

As a transmitter's it is TEC + 8. As a receiver's it is REC + 1: the node had lost arbitration to the
disturbance. It counts not at all where a recessive stuff bit of the arbitration field was monitored as
dominant (second exception of the transmitter's rule)."""
ERROR_FLAG_BITS = 6
ERROR_DELIMITER_BITS = 8
OVERLOAD_FLAG_BITS = ERROR_FLAG_BITS
OVERLOAD_DELIMITER_BITS = ERROR_DELIMITER_BITS
"""ISO 11898-1: an overload frame has the form of an active error frame."""


class Flip(NamedTuple):
    """One inverted bit: its index on the wire (0 = SOF, stuff bits counted, up to the last bit of EOF).

    seen_by: name of the one receiver at whose input it happens; None: on the wire itself, so everyone
    sees it.
    """

    bit: int
    seen_by: str | None = None


class Verdict(NamedTuple):
    """An error: its kind, the index of the bit at which it is detected, and how it counts."""

    kind: ErrorKind
    detected_bit: int
    sender: SenderCounts = "transmits"
    received: bool = False
    """Receivers had already taken the frame (last bit of EOF): they will get it twice."""


def _arbitration_end(frame: Frame) -> int:
    """Index on the wire of the last bit (RTR) of the arbitration field."""
    plain = header_bits(frame)[: 33 if frame.extended else 13]
    return len(stuff(plain[:-1]))


def seen_by_all(frame: Frame, bit: int) -> Verdict | None:
    """Verdict when `bit` is inverted on the wire itself; None when nothing comes of it."""
    body = stuff(stuffed_field(frame))
    length = len(body) + TAIL_BITS - 3
    if not 0 <= bit < length:
        return None
    ack = len(body) + 1
    if bit == ack:
        return Verdict("ack", bit)
    if bit == length - 1:
        return Verdict("form", bit, received=True)
    if bit >= len(body):
        return Verdict("form", bit)
    if body[bit] and bit <= _arbitration_end(frame):
        if bit >= 5 and not any(body[bit - 5 : bit]):
            return Verdict("stuff", bit, sender="spared")
        # The sender takes it for a stronger identifier and falls silent; six recessive bits later
        # everyone objects.
        return Verdict("stuff", bit + 6, sender="lost")
    return Verdict("bit", bit)


def overloads(frame: Frame, bit: int) -> bool:
    """Whether `bit` is the last of EOF. A receiver that sees it dominant has the frame already. It answers
    with an overload frame, which counts nowhere (ISO 11898-1, overload conditions)."""
    return bit == len(stuff(stuffed_field(frame))) + TAIL_BITS - 3 - 1


def seen_by_receiver(frame: Frame, bit: int) -> Verdict | None:
    """Verdict of one receiver at whose input `bit` is inverted; None when it takes the frame all the same."""
    body = stuff(stuffed_field(frame))
    wire = [*body, 1, 0, 1, *[1] * 7]  # as others acknowledge it
    if not 0 <= bit < len(wire):
        return None
    wire[bit] ^= 1
    start = wire.index(0)  # a receiver that missed SOF takes the next dominant bit for it
    verdict = receive(wire[start:])
    return verdict and verdict._replace(detected_bit=verdict.detected_bit + start)


def receive(wire: list[int]) -> Verdict | None:
    """A receiver's own view of the bits of one frame."""
    plain: list[int] = []
    run, last, end = 0, -1, None
    index = -1
    while True:  # the idle bus behind the last bit ends every frame: six equal bits are an error
        index += 1
        level = wire[index] if index < len(wire) else 1
        if run == 5:
            if level == last:
                return Verdict("stuff", index)
            run, last = 1, level
        else:
            run = run + 1 if level == last else 1
            last = level
            plain.append(level)
            end = end or _field_length(plain)
        if end is not None and len(plain) >= end and run != 5:
            return _tail(wire, index + 1, crc15(plain) == 0)


def _field_length(plain: list[int]) -> int | None:
    """Unstuffed bits from SOF to the end of the CRC, once the control field is in."""
    extended = plain[13:14] == [1]
    head = 39 if extended else 19
    if len(plain) < head:
        return None
    remote = plain[32] if extended else plain[12]
    code = int("".join(map(str, plain[head - 4 : head])), 2)
    return head + (0 if remote else 8 * min(code, 8)) + 15


def _tail(wire: list[int], start: int, crc_good: bool) -> Verdict | None:
    """CRC delimiter, ACK slot, ACK delimiter and EOF from index `start` on."""
    if wire[start : start + 1] == [0]:
        return Verdict("form", start)
    if not crc_good:
        return Verdict("crc", start + 2)
    # from the ACK delimiter on; a dominant last bit of EOF is an overload condition, not an error
    for index in range(start + 2, min(start + 9, len(wire))):
        if not wire[index]:
            return Verdict("form", index)
    return None


def first_difference(one: list[int], other: list[int]) -> tuple[int, bool] | None:
    """Where two senders' bits part: (index, whether `one` sent the recessive bit); None: they never do."""
    for index, (a, b) in enumerate(zip(one, other, strict=False)):
        if a != b:
            return index, a == 1
    return None
