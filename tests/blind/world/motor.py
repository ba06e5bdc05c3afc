"""One motor at constant speed, as on a stand: torque over angle, or its speed under a slow loop.

Sources: pole and slot numbers of motors on sale (12N8P to 36N42P, brushed armatures of 3 to 41 bars); orders
1 and 2 from eccentric mounting, p and 2p from magnets, slots from the stator, 6p from six-step currents, the
least common multiple from cogging (Hanselman, Brushless Motors, 2012). Sizes and noises are ASSUMPTIONS,
drawn wide: torque 0.01 to 50 N m, noise 0.2 to 5 % of it, speeds of 0.05 to 60 turn/s, 0.2 to 5 kHz.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from tests.blind.sealer.compiled import compiled
from tests.blind.world.made import TURN, Array, Rng, pick, wide

#: (poles, slots)
BRUSHLESS = (
    (8, 12), (6, 9), (10, 12), (14, 12), (16, 18), (22, 24), (42, 36), (8, 48), (10, 60), (4, 24), (28, 24),
)  # fmt: skip
BARS = (3, 5, 7, 9, 11, 13, 15, 23, 41)
GEARS = ((10, 25), (12, 60), (15, 75), (17, 54), (9, 100), (20, 47))
SUBSTEPS = 4


@dataclass
class Motor:
    """What its maker tells, and its stand. period_s, noise, quantum: of the log. wander: share of speed."""

    orders: list[int]
    gear: tuple[int, int] | None
    speed_log: bool
    scale: float  # N m, or turn/s
    noise: float
    quantum: float
    period_s: float
    rows: int
    wander: float
    wander_s: float
    bandwidth: float  # Hz, of a speed loop

    @property
    def floor(self) -> float:
        """Of one row of the response."""
        return math.hypot(self.noise, self.quantum / math.sqrt(12.0))

    def of_speed(self, rng: Rng, speed: float) -> None:
        """The response is the speed: its noise is 0.05 to 1 % of it."""
        self.scale, self.noise = speed, speed * wide(rng, 5e-4, 1e-2)
        self.quantum = self.noise * wide(rng, 0.05, 1.0)


@dataclass
class Lines:
    """Sines in angle (cycles per turn) or in time (Hz): amplitudes at size 1, phases of a file."""

    order: list[float] = field(default_factory=list)
    hertz: list[float] = field(default_factory=list)
    amplitude: list[float] = field(default_factory=list)

    def arrays(self, rng: Rng, size: float) -> tuple[Array, Array, Array, Array]:
        phase = rng.uniform(0.0, TURN, len(self.order))
        return np.array(self.order), np.array(self.hertz), size * np.array(self.amplitude), phase


def draw(rng: Rng, geared: bool) -> Motor:
    """A motor and its stand."""
    if not geared and rng.random() < 0.25:
        bars = int(pick(rng, *BARS))
        orders = sorted({1, 2, bars, 2 * bars})
    else:
        poles, slots = BRUSHLESS[int(rng.integers(len(BRUSHLESS)))]
        p = poles // 2
        orders = sorted({1, 2, p, poles, slots, 6 * p, math.lcm(poles, slots)})
    scale = wide(rng, 0.01, 50.0)
    noise = scale * wide(rng, 0.002, 0.05)
    return Motor(
        orders, GEARS[int(rng.integers(len(GEARS)))] if geared else None, False, scale, noise,
        noise * wide(rng, 0.05, 1.0), 1.0 / wide(rng, 200.0, 5000.0), int(wide(rng, 4000, 20000)),
        wide(rng, 1e-5, 1e-2), wide(rng, 0.05, 1.0), wide(rng, 0.3, 30.0),
    )  # fmt: skip


def speeds(rng: Rng, m: Motor, highest: float, lowest: float, files: int, turns: float) -> list[float]:
    """turn/s of every file: the highest order stays below an eighth of the rows' rate, the lowest comes
    round at least `turns` times."""
    seconds = m.rows * m.period_s
    least, most = turns / lowest / seconds, 1.0 / (8.0 * m.period_s * highest)
    first = wide(rng, least, max(most / 2.5, least))
    return [first * factor for factor in (1.0, rng.uniform(1.5, 2.4), rng.uniform(0.5, 0.7))[:files]]


def turned(rng: Rng, m: Motor, speed: float) -> Array:
    """Turns of a shaft that a stiff drive holds at a speed, which wanders a little."""
    keep = math.exp(-m.period_s / m.wander_s)
    kicks = rng.standard_normal(m.rows) * math.sqrt(1.0 - keep**2)
    walk = np.empty(m.rows)
    at = rng.standard_normal()
    for k, kick in enumerate(kicks):
        at = keep * at + kick
        walk[k] = at
    return np.asarray(np.cumsum(speed * (1.0 + m.wander * walk)) * m.period_s)


def summed(lines: Lines, turns: Array, t: Array, rng: Rng, size: float) -> Array:
    """The lines' torque over a file."""
    order, hertz, amplitude, phase = lines.arrays(rng, size)
    angle = order[:, None] * turns + hertz[:, None] * t
    return np.asarray(np.sum(amplitude[:, None] * np.cos(TURN * angle + phase[:, None]), axis=0))


@compiled
def _rate(
    w: float, x: float, s: float, t: float, goal: float, loop: Array, order: Array, hertz: Array, size: Array,
    phase: Array,
) -> float:  # fmt: skip
    """Acceleration: a loop of speed and its integral, and the lines."""
    out = -loop[0] * (w - goal) - loop[1] * s
    for k in range(order.shape[0]):
        out += size[k] * math.cos(2.0 * math.pi * (order[k] * x + hertz[k] * t) + phase[k])
    return float(out)


@compiled
def spun(
    rows: int, period: float, goal: float, loop: Array, order: Array, hertz: Array, size: Array, phase: Array
) -> Array:
    """(rows, 2): speed turn/s and turns of a motor under its speed loop; classical Runge-Kutta.

    loop: proportional 1/s and integral 1/s2 per inertia; size: turn/s2.
    """
    out = np.empty((rows, 2))
    h = period / SUBSTEPS
    w, x, s = goal, 0.0, 0.0
    for i in range(rows):
        out[i, 0], out[i, 1] = w, x
        for j in range(SUBSTEPS):
            t = i * period + j * h
            a1 = _rate(w, x, s, t, goal, loop, order, hertz, size, phase)
            w2, x2, s2 = w + h / 2 * a1, x + h / 2 * w, s + h / 2 * (w - goal)
            a2 = _rate(w2, x2, s2, t + h / 2, goal, loop, order, hertz, size, phase)
            w3, x3, s3 = w + h / 2 * a2, x + h / 2 * w2, s + h / 2 * (w2 - goal)
            a3 = _rate(w3, x3, s3, t + h / 2, goal, loop, order, hertz, size, phase)
            w4, x4, s4 = w + h * a3, x + h * w3, s + h * (w3 - goal)
            a4 = _rate(w4, x4, s4, t + h, goal, loop, order, hertz, size, phase)
            s += h / 6 * ((w - goal) + 2 * (w2 - goal) + 2 * (w3 - goal) + (w4 - goal))
            x += h / 6 * (w + 2 * w2 + 2 * w3 + w4)
            w += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4)
    return out


def loop_of(m: Motor) -> Array:
    """Proportional and integral part of a speed loop of that bandwidth, damping one."""
    p = TURN * m.bandwidth
    return np.array([p, p * p / 4.0])


def noise(rng: Rng, sigma: float, rows: int, kind: str) -> Array:
    """Gaussian, Student's t of three degrees, or with a walk of half its size over the file."""
    if kind == "heavy":
        return np.asarray(sigma * rng.standard_t(3, rows) / math.sqrt(3.0))
    white = sigma * rng.standard_normal(rows)
    if kind == "drift":
        white = white + 0.5 * sigma * np.cumsum(rng.standard_normal(rows)) / math.sqrt(rows)
    return np.asarray(white)
