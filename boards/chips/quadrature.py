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
        self._seen = self._seen + 1 if level == self._candidate else 1
        self._candidate = level
        if self._seen >= FILTER_SAMPLES:
            self.level = level
        return self.level


class Decoder:
    """Counts edges: all of them (x4), or those of channel A (x2)."""

    def __init__(self) -> None:
        self._place = 0

    def edge(self, a: int, b: int, *, x2: bool) -> int | None:
        """New levels: +1, -1, or 0 for no count; None: both channels changed at once, a count is lost."""
        before, self._place = self._place, _GRAY.index((a, b))
        if x2 and _GRAY[before][0] == a:
            return 0
        return (0, 1, None, -1)[self._place - before & 3]
