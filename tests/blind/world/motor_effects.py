"""What a motor at constant speed may hide: lines in angle or time, a drag, and things without a name."""

import math
from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from tests.blind.world.made import Array, Hidden, Rng, pick, wide
from tests.blind.world.motor import Lines, Motor

LINES = ("gear_eccentricity", "gear_mesh", "motor_cogging", "torque_ripple")
Shape = Callable[[Array, float], Array]  # over s and turn/s, N m at size 1


@dataclass
class Effect:
    """highest, lowest: order that must be resolved and come round. speeds: how many the log has."""

    hidden: Hidden
    lines: Lines = field(default_factory=Lines)
    shape: Shape | None = None
    highest: float = 12.0
    lowest: float = 1.0
    speeds: int = 1


def cogging(rng: Rng, m: Motor, name: str) -> Effect:
    """One order of the motor that stands out, up to two of its others; slots seldom, the turn often."""
    strongest = pick(rng, *m.orders)
    others = [o for o in m.orders if o != strongest and o < 6 * strongest]
    more = list(rng.choice(others, min(int(rng.integers(3)), len(others)), replace=False)) if others else []
    orders = [float(strongest), *(float(o) for o in more)]
    hidden = Hidden(
        name, "T", ("motor_angle", "axis_angle"), tuple(n for n in LINES if n != name), stage="motor",
        raw={"order": orders[0]},
    )  # fmt: skip
    sizes = [1.0, *(rng.uniform(0.15, 0.5) for _ in more)]
    return Effect(hidden, Lines(orders, [0.0] * len(orders), sizes), None, max(orders), min(orders))


def wheel(rng: Rng, m: Motor, name: str) -> Effect:
    """The wheel that the motor drives: off its centre once a turn, or its teeth."""
    driving, driven = m.gear or (1, 1)
    order = float(driving) if name == "gear_mesh" else driving / driven
    hidden = Hidden(
        name, "T", ("axis_angle", "motor_angle"), tuple(n for n in LINES if n != name),
        stage="mesh" if name == "gear_mesh" else "wheel", raw={"order": order},
    )  # fmt: skip
    return Effect(hidden, Lines([order], [0.0], [1.0]), None, max(order, 6.0), min(order, 1.0))


def bearing(rng: Rng, m: Motor, name: str) -> Effect:
    """6 to 12 balls in a bearing: they pass 0.4 or 0.6 times their number per turn (geometry of 62xx)."""
    balls = float(rng.integers(6, 13))
    order = balls * (pick(rng, 0.4, 0.6) + rng.uniform(-0.017, 0.017))
    hidden = Hidden(name, "T", ("axis_angle", "motor_angle"), ("unknown",), raw={"order": order})
    return Effect(hidden, Lines([order], [0.0], [1.0]), None, 2 * order, 1.0)


def disturbance(rng: Rng, m: Motor, name: str) -> Effect:
    """A fixed frequency: mains (50 or 60 Hz) or twice that, or one of a loop (ASSUMPTION)."""
    fits = [f for f in (50.0, 60.0, 100.0, 120.0) if f < 0.2 / m.period_s]
    hertz = pick(rng, *fits) if fits and rng.random() < 0.5 else wide(rng, 5.0, 50.0) / (m.rows * m.period_s)
    hidden = Hidden(name, "T", ("time", "command"), raw={"frequency": hertz})
    return Effect(hidden, Lines([0.0], [hertz], [1.0]), None, 6.0, 1.0, 1 + int(rng.random() < 0.7))


def drag(rng: Rng, m: Motor, name: str) -> Effect:
    """A brake that rubs from some time on."""
    start = rng.uniform(0.3, 0.6) * m.rows * m.period_s
    hidden = Hidden(name, "T", ("time",), ("preload_change",), raw={"start": start})
    return Effect(hidden, shape=lambda t, speed: np.where(t > start, 1.0, 0.0) + 0.0 * speed)


def tooth(rng: Rng, m: Motor, name: str) -> Effect:
    """A pulse once per turn of the wheel, about a tooth wide."""
    driving, driven = m.gear or (1, 1)
    width = rng.uniform(0.3, 0.8) / driven
    at = rng.uniform(0.1, 0.9)

    def pulse(turns: Array, _speed: float) -> Array:
        part = np.mod(turns * driving / driven - at + 0.5, 1.0) - 0.5
        return np.asarray(np.exp(-0.5 * (part / width) ** 2))

    hidden = Hidden(name, "T", ("axis_angle",), stage="wheel", raw={"width_turns": width})
    return Effect(hidden, shape=pulse, highest=3.0 * driving, lowest=driving / driven)


def telegraph(rng: Rng, m: Motor, name: str) -> Effect:
    """Something touches and lets go, at random: 20 to 60 times."""
    seconds = m.rows * m.period_s
    ends = np.sort(rng.uniform(0.0, seconds, 2 * int(rng.integers(10, 30))))
    hidden = Hidden(name, "T", ("time",))
    return Effect(hidden, shape=lambda t, _s: np.mod(np.searchsorted(ends, t), 2).astype(float))


def swept(rng: Rng, m: Motor, name: str) -> Effect:
    """A disturbance whose frequency runs through a factor of 1.5 to 3."""
    seconds = m.rows * m.period_s
    low, part = wide(rng, 5.0, 40.0) / seconds, rng.uniform(1.5, 3.0)

    def sweep(t: Array, _speed: float) -> Array:
        return np.asarray(np.cos(2 * math.pi * low * (t + (part - 1) * t**2 / 2 / seconds)))

    return Effect(Hidden(name, "T", ("time",), raw={"frequency": low}), shape=sweep)


def growing(rng: Rng, m: Motor, name: str) -> Effect:
    """Mains in the sensor's cable, that fades in: a line in time whose size is another at every moment."""
    seconds = m.rows * m.period_s
    hertz = wide(rng, 5.0, 50.0) / seconds
    rate = rng.uniform(2.0, 5.0)

    def fade(t: Array, _speed: float) -> Array:
        return np.asarray(np.exp(rate * (t / seconds - 1)) * np.cos(2 * math.pi * hertz * t))

    alike = ("command_disturbance",)
    return Effect(Hidden(name, "T", ("time", "clock"), alike, raw={"frequency": hertz}), shape=fade)


WHERE = {
    "motor_cogging": cogging, "torque_ripple": cogging, "gear_eccentricity": wheel, "gear_mesh": wheel,
    "bearing_pass": bearing, "command_disturbance": disturbance, "brake_drag": drag, "damaged_tooth": tooth,
    "outside_telegraph": telegraph, "outside_swept": swept, "outside_growing": growing,
}  # fmt: skip
GEARED = ("gear_eccentricity", "gear_mesh", "damaged_tooth")
OVER_ANGLE = ("damaged_tooth",)  # shapes over turns, not s
