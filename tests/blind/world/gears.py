"""Two sensors on either side of a gear: motor and output, read at rates of their own.

Sources of the orders of magnitude: a geared servo with an encoder on its output (play of 4.7 of 4096
units, four harmonics; ServoProject), gear boxes of 1:1 to 160:1 with 1 to 60 arcmin of play (makers' data
sheets). Motions, loads and drifts are ASSUMPTIONS, drawn wide.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from tests.blind.sealer.compiled import compiled
from tests.blind.world.made import TURN, Array, Rng, clock, pick, wide


@dataclass
class Gear:
    """ratio: motor turns per output turn. steps: of the sensors, output turns. noise: of the output's."""

    ratio: float
    in_step: float
    out_step: float
    noise: float
    period_s: float
    seconds: float
    files: int
    travel: float  # output turns
    speed: float  # output turns/s
    every: int  # rows of the input per reading of the output
    load: float  # N m, typical
    load_noise: float  # share of it

    @property
    def floor(self) -> float:
        """Of one difference, output turns."""
        return math.hypot(
            self.in_step / math.sqrt(12.0), self.out_step / math.sqrt(12.0), self.noise * self.out_step
        )


@dataclass
class Twist:
    """What lies between the sensors at size 1, output turns: gap, sines, wind-up per typical load, slips,
    lateness s, scale, drift per K, and three things without a name."""

    gap: float = 0.0
    sines: list[tuple[float, float, float]] = field(default_factory=list)  # per output turn, size, phase
    wind: float = 0.0
    slips: list[tuple[float, float]] = field(default_factory=list)  # share of the file, size
    late_s: float = 0.0
    scale: float = 0.0
    warm: float = 0.0
    bump: tuple[float, float, float] | None = None  # place, width, size
    shake: tuple[float, float] | None = None  # Hz, size
    cubic: float = 0.0

    def times(self, size: float) -> "Twist":
        """Another size of it."""
        return Twist(
            self.gap * size, [(n, a * size, p) for n, a, p in self.sines], self.wind * size,
            [(t, a * size) for t, a in self.slips], self.late_s * size, self.scale * size, self.warm * size,
            self.bump and (self.bump[0], self.bump[1], self.bump[2] * size),
            self.shake and (self.shake[0], self.shake[1] * size), self.cubic * size,
        )  # fmt: skip


def draw(rng: Rng) -> Gear:
    """A gear with two sensors."""
    ratio = pick(rng, 1.0, 3.0, 10.0, 25.0, 50.0, 100.0, 288.35)
    out_step = 1.0 / 2.0 ** int(rng.integers(11, 18))
    period = 1.0 / pick(rng, 50.0, 100.0, 200.0, 333.0, 1000.0)
    rows = wide(rng, 4000, 15000)
    return Gear(
        ratio, min(1.0 / 2.0 ** int(rng.integers(10, 15)) / ratio, out_step), out_step, wide(rng, 0.1, 2.0),
        period, rows * period, int(rng.integers(1, 4)), wide(rng, 0.3, 4.0), 1.0, 1, wide(rng, 0.05, 50.0),
        wide(rng, 0.003, 0.03),
    )  # fmt: skip


def motion(rng: Rng, g: Gear) -> Array:
    """Output turns over the rows: sweeps there and back at several speeds, about ten a file."""
    total = int(g.seconds / g.period_s)
    sweep = g.seconds / float(rng.integers(6, 14))
    parts: list[Array] = []
    at, rows, way = 0.0, 0, 1.0
    while rows < total:
        goal = way * g.travel * rng.uniform(0.35, 0.5)
        n = max(int(sweep * wide(rng, 0.5, 1.5) / g.period_s), 50)
        s = np.linspace(0.0, 1.0, n)
        parts.append(at + (goal - at) * (s - np.sin(TURN * s) / TURN))
        at, rows, way = goal, rows + n, -way
    return np.concatenate(parts)[:total]


def between(g: Gear, x: Array) -> float:
    """What a straight line between two of the output's readings misses of the motion, output turns."""
    bend = np.gradient(np.gradient(x, g.period_s), g.period_s)
    return float(np.max(np.abs(bend)) * (g.every * g.period_s) ** 2 / 8.0)


@compiled
def behind(x: Array, gap: float) -> Array:
    """The play operator: what is driven through a gap."""
    out = np.empty(x.shape[0])
    at = x[0]
    for k in range(x.shape[0]):
        at = min(max(at, x[k] - gap / 2.0), x[k] + gap / 2.0)
        out[k] = at
    return out


def torque(rng: Rng, g: Gear, x: Array) -> Array:
    """What the output lifts and rubs, as shares of the typical load: a weight, inertia, friction."""
    v = np.gradient(x, g.period_s)
    a = np.gradient(v, g.period_s)
    weight = np.sin(TURN * x + rng.uniform(0, TURN))
    return np.asarray(weight + 0.4 * np.tanh(v / (0.05 * np.std(v))) + 0.3 * a / (np.std(a) + 1e-300))


def temperature(rng: Rng, t: Array, begun: float, span: float) -> Array:
    """A housing that warms by 5 to 30 K and cools a little, degC over s of all files."""
    rise = wide(rng, 5.0, 30.0)
    u = (begun + t) / span
    return np.asarray(20.0 + rise * (1.0 - np.exp(-3.0 * u)) - 0.3 * rise * np.maximum(u - 0.6, 0.0))


def output(w: Twist, g: Gear, x: Array, load: Array, warm: Array, begun: float, seconds: float) -> Array:
    """The output's true angle as its sensor sees it, output turns."""
    t = clock(len(x), g.period_s)
    y = behind(x, w.gap) if w.gap else x.copy()
    for order, size, phase in w.sines:
        y = y + size * np.cos(TURN * order * x + phase)
    y = y - w.wind * load - w.cubic * (load**3 - load * np.mean(load**4) / np.mean(load**2))
    for when, size in w.slips:
        y = y + size * (t > when * seconds)
    y = y + w.scale * x + w.warm * (warm - 20.0)
    if w.bump is not None:
        y = y + w.bump[2] * np.exp(-0.5 * ((x - w.bump[0]) / w.bump[1]) ** 2)
    if w.shake is not None:
        y = y + w.shake[1] * np.sin(TURN * w.shake[0] * (begun + t))
    return np.asarray(np.interp(t - w.late_s, t, y) if w.late_s else y)
