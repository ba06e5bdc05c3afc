"""A mount under the stars: its worm, the drift of a pole that is off, and the air.

Sources: periodic errors of 5 to 40 arcsec peak to peak and seeing of 0.4 to 2 arcsec in 1 to 5 s (owners'
measurements, the PHD2 logs of the measured data). Seeing over seconds is coloured: a first-order process
of 2 to 15 s (ASSUMPTION, tip and tilt of a slow exposure) beside white noise of the centroid.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from tests.blind.world.made import TURN, Array, Hidden, Rng, pick, wide


@dataclass
class Sky:
    """What is above and below the mount. seeing: arcsec rms, of which a share is coloured."""

    exposure_s: float
    seeing: float
    coloured: float
    colour_s: float
    wander: float  # arcsec per root s
    drift: float  # arcsec per hour
    bend: float  # arcsec, over an hour


@dataclass
class Error:
    """A periodic error: periods s, amplitudes at size 1, phases; jumps: s and arcsec at size 1."""

    hidden: Hidden
    periods: list[float] = field(default_factory=list)
    amplitudes: list[float] = field(default_factory=list)
    phases: list[float] = field(default_factory=list)
    jumps: list[tuple[float, float]] = field(default_factory=list)

    def at(self, t: Array) -> Array:
        """Arcsec over s."""
        out = np.zeros(len(t))
        for period, size, phase in zip(self.periods, self.amplitudes, self.phases, strict=True):
            out += size * np.cos(TURN * t / period + phase)
        for when, size in self.jumps:
            out += size * (t > when)
        return out


def draw(rng: Rng) -> Sky:
    """A night."""
    return Sky(
        pick(rng, 1.0, 1.5, 2.0, 2.5, 3.0, 4.0), wide(rng, 0.3, 2.0), rng.uniform(0.2, 0.8),
        wide(rng, 2.0, 15.0), wide(rng, 0.003, 0.03), float(rng.uniform(-30.0, 30.0)), wide(rng, 0.3, 5.0),
    )  # fmt: skip


def air(rng: Rng, s: Sky, rows: int, step_s: float, kind: str) -> Array:
    """Coloured seeing, white noise (Gaussian or heavy-tailed) and a walk of the mount's feet."""
    keep = math.exp(-step_s / s.colour_s)
    kicks = rng.standard_normal(rows) * math.sqrt(1.0 - keep**2)
    slow = np.empty(rows)
    at = rng.standard_normal()
    for k, kick in enumerate(kicks):
        at = keep * at + kick
        slow[k] = at
    white = rng.standard_t(3, rows) / math.sqrt(3.0) if kind == "heavy" else rng.standard_normal(rows)
    walk = (
        (3.0 if kind == "drift" else 1.0)
        * s.wander
        * math.sqrt(step_s)
        * np.cumsum(rng.standard_normal(rows))
    )
    mixed = math.sqrt(s.coloured) * slow + math.sqrt(1.0 - s.coloured) * white
    return np.asarray(s.seeing * mixed + walk)


def slow(s: Sky, t: Array, rng: Rng) -> Array:
    """Polar drift, and a bend of it by refraction and flexure."""
    x = t / 3600.0
    return np.asarray(s.drift * x + s.bend * (x - x.mean()) ** 2 * float(rng.choice([-1.0, 1.0])))


def worm(rng: Rng, period_s: float, stage: str = "worm") -> Error:
    """A worm: its turn, and up to four harmonics of it."""
    count = int(rng.integers(0, 5))
    sizes = [1.0, *(rng.uniform(0.1, 0.6) / (k + 1) for k in range(count))]
    periods = [period_s / (k + 1) for k in range(count + 1)]
    phases = [float(x) for x in rng.uniform(0, TURN, count + 1)]
    hidden = Hidden("gear_eccentricity", "K", ("axis_angle", "time"), stage=stage, raw={"period_s": period_s})
    return Error(hidden, periods, sizes, phases)


def stray(rng: Rng, period_s: float, parts_s: tuple[float, ...]) -> Error:
    """A period of no part that is declared, nor within a tenth of one that the mount's name allows."""
    periods = [period_s * factor for factor in (0.53, 0.618, 0.71, 0.83, 1.36)]
    free = [x for x in periods if all(abs(x / part - 1.0) > 0.1 for part in parts_s)]
    part = pick(rng, *(free or periods))
    hidden = Hidden("outside_period", "K", ("time", "axis_angle"), raw={"period_s": part})
    return Error(hidden, [part], [1.0], [float(rng.uniform(0, TURN))])


def flops(rng: Rng, seconds: float) -> Error:
    """A mirror that tips over: three to six jumps to either side."""
    count = int(rng.integers(3, 7))
    times = np.sort(rng.uniform(0.08, 0.92, count)) * seconds
    jumps = [(float(t), float(rng.choice([-1.0, 1.0]) * rng.uniform(0.6, 1.4))) for t in times]
    return Error(Hidden("outside_flop", "K", ("time",)), jumps=jumps)
