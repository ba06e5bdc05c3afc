"""Mutants drawn at random over a whole room, and between which shares that room's then lies."""

import random
from collections.abc import Mapping, Sequence

from scipy.stats import binomtest

from tests.mutation.operators import Mutant

SURE = 0.95
"""Of the interval, as is usual."""


def drawn(cases: Mapping[str, Sequence[Mutant]], count: int, seed: int) -> dict[str, list[Mutant]]:
    """So many of the mutants by module, or all; each is as likely as any other. Modules keep their order."""
    every = [(path, each) for path, some in cases.items() for each in some]
    places = sorted(random.Random(seed).sample(range(len(every)), min(count, len(every))))
    found = dict[str, list[Mutant]]()
    for path, each in (every[place] for place in places):
        found.setdefault(path, []).append(each)
    return found


def interval(killed: int, total: int) -> tuple[float, float]:
    """Wilson's of a share, per cent. No room is imported for it: that would hide what its import runs."""
    low, high = binomtest(killed, total).proportion_ci(SURE, method="wilson")
    return 100 * float(low), 100 * float(high)
