"""A joint under gravity behind a sampled loop; friction after Karnopp, with a Stribeck dip.

Karnopp, Computer simulation of stick-slip friction, 1985: within a small band of speeds the joint sticks
until the torque on it exceeds the break-away. The other joint moves on a path of its own.
"""

import math
from collections.abc import Mapping
from typing import Final

import numpy as np

from tests.blind.sealer.compiled import compiled
from tests.blind.world.made import Array

NAMES: Final = (
    # joint: kg m2, N m, N m s/rad, rad/s; torque per unit of effort
    "INERTIA", "COUL", "STIC", "VS", "VISC", "GAIN",
    # loop: effort per rad, per rad/s, per rad s; end of the effort; steps of position and effort; noise of it
    "KP", "KD", "KI", "TOP", "STEP", "EFFORT_STEP", "NOISE",
    # weight of this joint and beyond the other joint, N m
    "GRAV", "GRAV_P", "GRAV2",
    # hidden
    "CABLE", "CABLE_C", "POSF", "POSF_K", "POSF_P", "LOADF", "DRAG", "DRAG_T", "WARM", "WARM_TAU", "UPSET",
    "UPSET_F", "LINE", "LINE_K", "LINE_P", "COUPLING", "STOP", "STOP_X", "BEND",
)  # fmt: skip
INDEX: Final = {name: place for place, name in enumerate(NAMES)}
(
    INERTIA, COUL, STIC, VS, VISC, GAIN, KP, KD, KI, TOP, STEP, EFFORT_STEP, NOISE, GRAV, GRAV_P, GRAV2,
    CABLE, CABLE_C, POSF, POSF_K, POSF_P, LOADF, DRAG, DRAG_T, WARM, WARM_TAU, UPSET, UPSET_F, LINE, LINE_K,
    LINE_P, COUPLING, STOP, STOP_X, BEND,
) = range(len(NAMES))  # fmt: skip
EFFORT, X, V, A, OWN = range(5)  # columns of the rows
TICK_S = 1e-4
REST = 1e-3  # of the Stribeck speed: within it the joint may stick


@compiled
def drive(
    p: Array, goal: Array, other: Array, bend: Array, noise: Array, period: float, start: float
) -> Array:
    """(n, 5): effort, position, speed, acceleration, torque of what is hidden; a row per sample.

    goal (n,) rad; other (n,) the other joint's angle and bend (n,) its acceleration; noise (n,) of effort 1.
    """
    n = goal.shape[0]
    steps = max(int(period / TICK_S + 0.5), 1)
    h = period / steps
    rows = np.zeros((n, 5))
    x, v, integral = goal[0], 0.0, 0.0
    seen = math.floor(x / p[STEP]) * p[STEP]
    for i in range(n):
        before, seen = seen, math.floor(x / p[STEP]) * p[STEP]
        error = goal[i] - seen
        wanted = (goal[i] - goal[max(i - 1, 0)]) / period
        integral += p[KI] * error * period
        u = p[KP] * error + p[KD] * (wanted - (seen - before) / period) + integral + p[NOISE] * noise[i]
        u = math.floor(min(max(u, -p[TOP]), p[TOP]) / p[EFFORT_STEP] + 0.5) * p[EFFORT_STEP]
        rows[i, 0], rows[i, 1], rows[i, 2] = u, x, v
        kicks, own = 0.0, 0.0
        for j in range(steps):
            t = start + i * period + j * h
            into = i * period + j * h
            push = p[GAIN] * (u - p[BEND] * u * abs(u) / p[TOP])
            extra = push - p[GAIN] * u
            extra += p[GAIN] * p[UPSET] * math.sin(2.0 * math.pi * p[UPSET_F] * t)
            extra += p[LINE] * math.cos(p[LINE_K] * x + p[LINE_P]) - p[CABLE] * (x - p[CABLE_C])
            extra -= p[COUPLING] * bend[i] + p[STOP] * max(x - p[STOP_X], 0.0) ** 2
            weight = p[GRAV] * math.sin(x - p[GRAV_P]) + p[GRAV2] * math.sin(x + other[i] - p[GRAV_P])
            free = p[GAIN] * u + extra - weight
            level = p[LOADF] * abs(push) + p[POSF] * math.cos(p[POSF_K] * x + p[POSF_P])
            level += p[WARM] * math.exp(-t / max(p[WARM_TAU], 1e-9))
            if into > p[DRAG_T]:
                level += p[DRAG]
            dip = (p[STIC] - p[COUL]) * math.exp(-((v / p[VS]) ** 2))
            if abs(v) <= REST * p[VS]:
                hold = p[STIC] + level
                a = -v / h if abs(free) <= hold else (free - math.copysign(hold, free)) / p[INERTIA]
                more = 0.0
            else:
                way = math.copysign(1.0, v)
                a = (free - way * (p[COUL] + dip + level) - p[VISC] * v) / p[INERTIA]
                more = way * (level + dip)
                if (v + h * a) * v < 0.0:
                    a = -v / h
            v += h * a
            x += h * v
            kicks += a / steps
            own += (extra - weight - more) / steps
        rows[i, 3], rows[i, 4] = kicks, own
    return rows


def vector(values: Mapping[str, float]) -> Array:
    """The kernel's numbers from names; what is not given is 0."""
    out = np.zeros(len(NAMES))
    for name, value in values.items():
        out[INDEX[name]] = value
    return out
