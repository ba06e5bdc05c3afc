"""A column that stops at the end of its converter: noise would spread it over the neighbouring counts."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from calibration.readers.run import Array, Run

# of the effort's range, that a column at its end must hold against: a steady effort makes a steady current.
# 2 % of it, over a few ohm, are tens of a converter's counts (development seed 1044: 0.025 at a clipped end)
DRIVEN = 0.02
# rows at the very end of a column's range, which are more than TIMES those a count before it, and BESIDE. No
# sound current of axis seeds 1043 and 1044 has more than 66 at its highest count, and those had 504 before it
PILE, TIMES, BESIDE = 60, 3, 20


def piled_at(x: Array, effort: Array, end: float, before: float) -> tuple[int, int] | None:
    """Rows of `x` (n,) at its `end`, and at `before`, a count nearer; None where they do not pile up there.
    `effort` (n,) is what drives it."""
    at = x == end
    if not at.any() or np.ptp(effort[at]) < DRIVEN * np.ptp(effort):
        return None
    piled, next_to = int(at.sum()), int(np.sum(np.abs(x - before) < 0.1 * abs(end - before)))
    return (piled, next_to) if piled >= PILE and piled > TIMES * next_to + BESIDE else None


def converter_end(runs: Sequence[Run], names: Sequence[str]) -> float | None:
    """What the currents `names` of two motors stop at, the same for both and in all runs; None where they
    pile up nowhere."""
    have = [n for n in names if all(n in r.columns for r in runs)]
    if not have:
        return None
    x = np.concatenate([r.columns[n] for n in have for r in runs])
    effort = np.concatenate([r.columns["effort"] for _ in have for r in runs])
    good = np.isfinite(x) & np.isfinite(effort)
    x, effort = x[good], effort[good]
    below = x[x < x.max(initial=-np.inf)]
    if not len(below):  # nothing, or one number, which has no end
        return None
    end = float(x.max())
    return end if piled_at(x, effort, end, float(below.max())) is not None else None
