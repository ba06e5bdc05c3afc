"""Do both encoders see the same motion? A stuck or lost one would let the loop run away."""

from boards.axis.profile import UNIT_SHIFT

_LIMIT = round(40.0 / 1_296_000 * 112_896_000) << UNIT_SHIFT
"""Difference that may build up between two looks, 250 ms apart: 40 arcsec, in Q18 counts. ASSUMPTION.

The age of a position is known to 0.1 ms, 0.7 arcsec at slew. A position loop whose encoder is stuck
corrects by far more than this, so a stuck absolute encoder shows as well as a stuck incremental one."""


class EncoderWatch:
    """Compares the sum of the incremental counts with the absolute position."""

    __slots__ = ("_before", "counts")

    def __init__(self) -> None:
        self.counts = 0
        self._before: int | None = None

    def forget(self) -> None:
        """The next look starts afresh: there was no position for a while."""
        self._before = None

    def disagree(self, position_q18: int) -> bool:
        """Look at an absolute position, Q18 counts; True when the encoders have parted since the last."""
        difference = position_q18 - (self.counts << UNIT_SHIFT)
        before = self._before
        self._before = difference
        return before is not None and abs(difference - before) > _LIMIT
