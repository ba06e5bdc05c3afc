"""References: smooth moves there and back at several speeds, with rests."""

import numpy as np

from tests.blind.drives.families import Family, Rng
from tests.blind.drives.slots import Array


def reference(rng: Rng, f: Family, seconds: float) -> Array:
    """Position over samples: quintic moves between drawn places at drawn mean speeds."""
    parts: list[Array] = []
    at, rows = 0.0, 0
    way = 1.0
    while rows * f.period_s < seconds:
        travel = rng.uniform(*f.travel) * way
        if rng.random() < 0.8:
            way = -way
        travel = float(np.clip(at + travel, -f.travel[1], f.travel[1]) - at)
        low, high = f.speed
        speed = low * (high / low) ** rng.random()
        n = max(int(1.9 * abs(travel) / speed / f.period_s), 20)
        s = np.linspace(0.0, 1.0, n)
        parts.append(at + travel * (10 * s**3 - 15 * s**4 + 6 * s**5))
        rest = int(rng.uniform(0.05, 0.4) / f.period_s)
        at += travel
        parts.append(np.full(rest, at))
        rows += n + rest
    return np.concatenate(parts)[: int(seconds / f.period_s)]
