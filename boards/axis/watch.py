"""Do both encoders see the same motion? A stuck or lost one would let the loop run away."""

from typing import Final

from boards.axis.profile import UNIT_SHIFT
from bus.protocol.scales import COUNTS_PER_TURN
from bus.units import ARCSEC_PER_TURN

_LIMIT: Final = round(40.0 / ARCSEC_PER_TURN * COUNTS_PER_TURN) << UNIT_SHIFT
"""Difference that may build up between two looks, 250 ms apart: 40 arcsec, in Q18 counts. ASSUMPTION.

The age of a position is known to 0.1 ms, 0.7 arcsec at slew. A position loop whose encoder is stuck
corrects by far more than this. So a stuck absolute encoder shows as well as a stuck incremental one."""


class EncoderWatch:
    """Compares the sum of the incremental counts since the last look with the absolute position's change.

    counts: 32 bit; 50 ticks of 16 bits are less.
    """

    def __init__(self) -> None:
        self.counts = 0
        self._before: int | None = None

    def forget(self) -> None:
        """The next look starts afresh: there was no position for a while."""
        self._before = None
        self.counts = 0

    def disagree(self, position_q18: int) -> bool:
        """Look at an absolute position, Q18 counts; True when the encoders have parted since the last."""
        before, counts = self._before, self.counts
        self._before, self.counts = position_q18, 0
        return before is not None and abs(position_q18 - before - (counts << UNIT_SHIFT)) > _LIMIT
