"""Two encoder channels to counts: what every QEI has at its inputs."""

_GRAY = ((0, 0), (1, 0), (1, 1), (0, 1))
"""A and B over one line, counting up."""
FILTER_SAMPLES = 3
"""Equal samples before an input counts (hardware.md 3.4)."""


def levels(count: int) -> tuple[int, int]:
    """A and B of an encoder that stands at `count`."""
    return _GRAY[count & 3]


class Filter:
    """Digital filter of one input: takes a level after three equal samples."""

    def __init__(self) -> None:
        self.level = 0
        self._candidate = 0
        self._seen = FILTER_SAMPLES

    def sample(self, level: int) -> int:
        """One sample in, the filtered level out."""
        if level != self._candidate:
            self._candidate, self._seen = level, 1
        elif self._seen < FILTER_SAMPLES:
            self._seen += 1
        if self._seen >= FILTER_SAMPLES:
            self.level = level
        return self.level


class Decoder:
    """Counts edges: all of them (x4), or those of channel A (x2). lost: both channels changed at once."""

    def __init__(self, a: int = 0, b: int = 0) -> None:
        self._a, self._b = a, b
        self.lost = 0

    def edge(self, a: int, b: int, *, x2: bool) -> int:
        """New levels: +1, -1, or 0 for no count."""
        before, now = _GRAY.index((self._a, self._b)), _GRAY.index((a, b))
        turned_a = a != self._a
        self._a, self._b = a, b
        step = (now - before) & 3
        if step == 2:
            self.lost += 1
            return 0
        if not step or (x2 and not turned_a):
            return 0
        return 1 if step == 1 else -1
