"""Arms that lift something, and the moves that people record of them.

Sources of the orders of magnitude: a hobby servo with 0.49 kg at 0.1 m (Rhoban BAM), a robot arm's
shoulder of 10 A against its weight (UR10e). From there to either side: masses 0.1 to 20 kg, lengths 0.05
to 0.6 m, steps of 1024 to 65536 a turn, 50 to 500 Hz. Ratios between friction, weight and gains are
ASSUMPTIONS, drawn wide.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from tests.blind.world import arm_kernel as kernel
from tests.blind.world.made import TURN, Array, Rng, clock, pick, wide

GRAVITY = 9.81  # m/s2
FEWEST_ROWS = 250
"""Of a file: fewer than 200 are refused, whatever is in them."""


@dataclass
class Arm:
    """values: of the kernel. effort: the unit of its column. moves, rest: how it is driven."""

    values: dict[str, float]
    effort: str
    force: str
    period_s: float
    seconds: float
    files: int
    stroke: float  # rad
    centre: float
    speed: float  # rad/s, typical
    one_way: bool  # the second file moves up only
    gear: float  # motor turns per joint turn
    rest_s: float
    sensor_noise: float = 0.0  # of the effort's column; 0: what is sent is logged
    loads: list[float] = field(default_factory=list)  # weight of each file over the first one's

    @property
    def floor(self) -> float:
        """N m of one row: the effort's noise and step, and what steps of the position put into the effort."""
        v = self.values
        wobble = v["KP"] * v["STEP"] / math.sqrt(12.0), v["KD"] * v["STEP"] / self.period_s / math.sqrt(12.0)
        noise = math.hypot(v["NOISE"], self.sensor_noise)
        return v["GAIN"] * math.hypot(noise, v["EFFORT_STEP"] / math.sqrt(12.0), *wobble)


def draw(rng: Rng) -> tuple[Arm, float]:
    """A joint, and the weight (N m) that it may have to lift."""
    mass, length = wide(rng, 0.1, 20.0), wide(rng, 0.05, 0.6)
    weight = mass * GRAVITY * length
    inertia = mass * length**2 * wide(rng, 1.1, 4.0)  # with the rotor behind its gears
    coulomb = weight * wide(rng, 0.03, 0.3)
    speed = wide(rng, 0.2, 3.0)
    kind = str(rng.choice(["duty", "current", "torque"]))
    top = {"duty": 1.0, "current": wide(rng, 1.0, 20.0), "torque": weight * 3.0}[kind]
    gain = 1.0 if kind == "torque" else weight * rng.uniform(2.5, 5.0) / top
    stiff = inertia * (TURN * wide(rng, 1.0, 4.0)) ** 2
    period = 1.0 / pick(rng, 50.0, 100.0, 200.0, 250.0, 500.0)
    proportional = rng.random() < 0.5
    values = {
        "INERTIA": inertia, "COUL": coulomb, "STIC": coulomb, "VS": 0.1 * speed,
        "VISC": coulomb * wide(rng, 0.1, 1.0) / speed, "GAIN": gain, "TOP": top, "KP": stiff / gain,
        "KD": 2 * rng.uniform(0.4, 1.0) * math.sqrt(stiff * inertia) / gain,
        "KI": 0.0 if proportional else 0.5 * stiff / gain, "STEP": TURN / 2.0 ** int(rng.integers(10, 17)),
        "EFFORT_STEP": top / pick(rng, 255.0, 1000.0, 2048.0, 4096.0), "NOISE": top * wide(rng, 3e-4, 3e-3),
    }  # fmt: skip
    unit = {"duty": ("duty", "duty"), "current": ("A", "A"), "torque": ("N m", "N m")}[kind]
    stroke = wide(rng, 0.25, 2.5)
    arm = Arm(
        values, *unit, period, wide(rng, 6.0, 40.0), int(rng.integers(1, 7)), stroke,
        float(rng.uniform(-1.0, 1.0)), speed, bool(rng.random() < 0.3), pick(rng, 50.0, 101.0, 160.0, 288.35),
        float(wide(rng, 0.05, 1.0)),
    )  # fmt: skip
    if kind != "duty":
        arm.sensor_noise, values["NOISE"] = values["NOISE"], 0.0
    return arm, weight


def path(rng: Rng, a: Arm, up_only: bool) -> Array:
    """Moves of a raised cosine between drawn places; `up_only`: slowly up, no measured way back."""
    parts: list[Array] = []
    rows, total = 0, int(a.seconds / a.period_s)
    at = a.centre - a.stroke / 2 if up_only else a.centre + a.stroke * rng.uniform(-0.5, 0.5)
    while rows < total:
        if up_only:
            goal = at + a.stroke / 2.5
            if goal > a.centre + a.stroke / 2 + 1e-9:
                break
        else:
            goal = a.centre + a.stroke * rng.uniform(-0.5, 0.5)
            if abs(goal - at) < 0.2 * a.stroke:
                goal = a.centre + math.copysign(0.5 * a.stroke, a.centre - at)
        n = max(int(abs(goal - at) / (a.speed * wide(rng, 0.4, 1.6)) / a.period_s), 12)
        s = np.linspace(0.0, 1.0, n)
        parts += [at + (goal - at) * (s - np.sin(TURN * s) / TURN)]
        still = max(int(a.rest_s * rng.uniform(0.5, 1.5) / a.period_s), 2)
        parts += [np.full(still, goal)]
        at, rows = goal, rows + n + still
    whole = np.concatenate(parts)[:total]
    return np.pad(whole, (0, max(FEWEST_ROWS - len(whole), 0)), mode="edge")  # it rests there


def paths(rng: Rng, a: Arm) -> list[Array]:
    """The set points of every file."""
    return [path(rng, a, a.one_way and k == 1) for k in range(a.files)]


def other(rng: Rng, a: Arm, rows: int) -> tuple[Array, Array]:
    """Angle and acceleration of the joint beyond this one: slow, with a swing of its own."""
    t = clock(rows, a.period_s)
    out, bend = np.zeros(rows), np.zeros(rows)
    for _ in range(3):
        w, size, phase = TURN * wide(rng, 0.05, 0.5), rng.uniform(0.2, 0.6), rng.uniform(0, TURN)
        out += size * np.sin(w * t + phase)
        bend -= size * w**2 * np.sin(w * t + phase)
    return out, bend


def run(a: Arm, hidden: dict[str, float], goals: list[Array], number: int) -> list[tuple[Array, Array]]:
    """(rows of the kernel, the other joint's angle) of every file. Times of effects are shares of a file."""
    out, begun = [], 0.0
    for k, goal in enumerate(goals):
        rng = np.random.default_rng([number, 5, k])
        angle, bend = other(rng, a, len(goal))
        span = len(goal) * a.period_s
        load = a.loads[k] if a.loads else 1.0
        scaled = {n: v * span if n == "DRAG_T" else v for n, v in hidden.items()}
        values = {**a.values, **scaled}
        values["GRAV"] = values.get("GRAV", 0.0) * load
        noise = rng.standard_normal(len(goal))
        p = kernel.vector(values)
        out.append((kernel.drive(p, goal, angle, bend, noise, a.period_s, begun), angle))
        begun += span + 2.0
    return out
