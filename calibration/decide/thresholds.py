"""Numbers that verdict and probability hang on: value, unit, reason, and the seeds they were set on."""

from __future__ import annotations

from dataclasses import dataclass

# after / floor beyond which something is still missing: the figure, not fitted
STILL_MISSING = 2.0
# of the held-out mean square, that an effect with its sign turned may take off by chance
FLIPPED_BY_LUCK = 0.001


@dataclass(frozen=True)
class Earned:
    """Answers of one kind on sealed development logs: how many, and how many of their first names were
    right."""

    right: int
    named: int

    @property
    def probability(self) -> float:
        """Laplace's rule of succession: never 0 or 1, and near a half where hardly any were seen."""
        return (self.right + 1) / (self.named + 2)


# Axis logs of tests/blind, development seeds 1025 and 1027, set strata: all 126 effects in the answers that
# the finder of commit b383650 gave. No answer was ambiguous there: that kind keeps the two of seed 1800
# (commit b92d544). docs/blind.md has the intervals.
AXIS_EARNED = {
    "sole": Earned(98, 98),
    "further": Earned(16, 18),
    "ambiguous": Earned(0, 2),
    "above": Earned(9, 10),
}
