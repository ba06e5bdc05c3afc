"""What a controller makes of bits that were sent at another bit rate than its own."""

from typing import NamedTuple

from bus.can.disturbance import receive


class BitTiming(NamedTuple):
    """A controller's bit: length in ns, sample point and jump width as shares of it, and the relative
    difference of bit rates it still follows.

    tolerance: of two nodes, together (Bosch CAN 2.0, part A, section 9: each oscillator has half of it).
    """

    bit_ns: float
    sample_point: float = 0.75
    jump: float = 0.125
    tolerance: float = 0.01

    def fits(self, bit_ns: float) -> bool:
        """Whether a node with this timing follows a bus of `bit_ns`."""
        return abs(self.bit_ns / bit_ns - 1.0) <= self.tolerance


def sample(levels: list[int], sent_ns: float, timing: BitTiming) -> list[int]:
    """Levels a receiver with `timing` takes for the bits of a frame sent with `sent_ns` a bit.

    levels: the frame from its start of frame on; recessive follows. Edges from recessive to dominant move the
    receiver's bit by at most its jump width (ISO 11898-1, resynchronisation).
    """
    edges = [k * sent_ns for k in range(1, len(levels)) if levels[k - 1] and not levels[k]]
    bit, jump = timing.bit_ns, timing.jump * timing.bit_ns
    start, end = 0.0, len(levels) * sent_ns + 16 * timing.bit_ns
    taken: list[int] = []
    last = 1
    k = 0
    while start < end:
        index = int((start + timing.sample_point * bit) / sent_ns)
        level = levels[index] if index < len(levels) else 1
        taken.append(level)
        length = bit
        while k < len(edges) and edges[k] < start + bit:
            late = edges[k] - start
            early = late > timing.sample_point * bit
            if level if early else last:  # at the sample point before the edge
                length += max(-jump, min(jump, late - bit if early else late))
            k += 1
        last = level
        start += length
    return taken


def error_ns(levels: list[int], sent_ns: float, timing: BitTiming) -> float | None:
    """Time from start of frame at which a receiver with `timing` sees an error; None: it takes the frame."""
    taken = sample(levels, sent_ns, timing)
    first = taken.index(0) if 0 in taken else len(taken)
    verdict = receive(taken[first:])
    return None if verdict is None else (verdict.detected_bit + first + 1) * timing.bit_ns
