"""Numbers that verdict and probability hang on: value, unit, reason, and the seeds they were set on."""

from __future__ import annotations

# after / floor beyond which something is still missing: the figure, not fitted
STILL_MISSING = 2.0
# of the held-out mean square, that an effect with its sign turned may take off by chance
FLIPPED_BY_LUCK = 0.001
