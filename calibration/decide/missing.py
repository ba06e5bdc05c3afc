"""What is still above the floor when the answer is given: how much, and which domain it lives in."""

from __future__ import annotations

from typing import Any

import numpy as np

from calibration.decide.select import Selection
from calibration.decide.thresholds import STILL_MISSING
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

BINS, FEWEST_BINS = 24, 8  # of a domain, each with as many rows as the next
ROWS = 10  # per bin
LEAST_SHARE = 0.1  # of the mean square, explained on rows the means are not made of, before a domain is named
# the same for a channel that is twice above its floor, where a fault comes and goes: chance alone has none on
# rows that the means are not made of (development seed 1043: a brush that sticks at times has 0.07)
SHOWN = 0.05


def above_floor(error: dict[str, dict[str, Any]]) -> dict[str, float]:
    """after / floor of every channel in which it is beyond STILL_MISSING; a floor not known says nothing."""
    found = {k: e["after"] / e["floor"] for k, e in error.items() if e["floor"]}
    return {k: r for k, r in found.items() if r > STILL_MISSING}


def lives_in(s: Selection, domains: dict[str, Array], stacked: int = 1) -> tuple[str | None, float, str]:
    """The domain whose bin means on training rows take most off the held-out residual, or off its size; None
    where none does; how much of its mean square; and in words. Of several things one after another in the
    channel (`stacked`: two motors) the one that leaves most is looked at."""
    e, p = s.after.residual, s.problem
    mine = np.arange(len(e)) // (len(e) // stacked)
    worst = max(range(stacked), key=lambda k: float(np.sum(e[p.test & (mine == k)] ** 2)))
    train, test = p.train & (mine == worst), p.test & (mine == worst)
    size = np.abs(e) - float(np.mean(np.abs(e)[train])) if train.any() else e
    shares = {
        (name, how): domain_share(z, x, train, test)
        for z, how in ((e, ""), (size, ", in size"))
        for name, x in domains.items()
    }
    best = max(shares, key=lambda k: shares[k], default=None)
    if best is None or shares[best] < SHOWN:
        return None, 0.0, "in none of " + ", ".join(domains)
    return best[0], shares[best], f"over {best[0]}{best[1]} ({100 * shares[best]:.0f} % of its mean square)"


def domain_share(e: Array, x: Array, train: Mask, test: Mask) -> float:
    """Share of the mean square of `e` (n,) on `test` rows that its bin means over `x` (n,), made on `train`
    rows, take away; 0 where the rows are too few."""
    bins = int(min(BINS, train.sum() // ROWS, test.sum() // ROWS))
    if bins < FEWEST_BINS or np.ptp(x[train]) == 0:
        return 0.0
    edges = np.unique(np.quantile(x[train], np.linspace(0, 1, bins + 1)[1:-1]))
    place = np.searchsorted(edges, x)
    count = np.maximum(np.bincount(place[train], minlength=len(edges) + 1), 1)
    means = np.bincount(place[train], e[train], len(edges) + 1) / count
    return float(1 - np.mean((e - means[place])[test] ** 2) / max(float(np.mean(e[test] ** 2)), 1e-300))
