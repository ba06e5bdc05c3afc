"""Random numbers that depend on a seed and a count only: no state, any order, the same on every machine."""

from math import cos, log, pi, sqrt

import numpy as np

from plant.compiled import inner

GOLDEN = np.uint64(0x9E3779B97F4A7C15)  # SplitMix64 (Steele, Lea, Flood 2014)
FIRST = np.uint64(0xBF58476D1CE4E5B9)
SECOND = np.uint64(0x94D049BB133111EB)
SHIFT30, SHIFT27, SHIFT31, SHIFT11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
ONE, TWO = np.uint64(1), np.uint64(2)
UNIT = 1.0 / 9007199254740992.0  # 2**-53


@inner
def uniform(seed: np.uint64, count: np.uint64) -> float:
    """Return a number in (0, 1) for two unsigned integers."""
    bits = np.uint64(seed) + GOLDEN * np.uint64(count + ONE)
    bits = (bits ^ (bits >> SHIFT30)) * FIRST
    bits = (bits ^ (bits >> SHIFT27)) * SECOND
    bits = bits ^ (bits >> SHIFT31)
    return (float(bits >> SHIFT11) + 0.5) * UNIT


@inner
def normal(seed: float, count: float) -> float:
    """Return a standard normal number of seed and count, whole floats below 2**53 (Box and Muller)."""
    base = np.uint64(seed)
    place = TWO * np.uint64(count)
    return sqrt(-2.0 * log(uniform(base, place))) * cos(2.0 * pi * uniform(base, place + ONE))
