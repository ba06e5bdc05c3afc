"""Bristles along the drive's own motion, beside the one that drives it: what a friction effect adds to the
torque of that motion, and what calibrated figures that are one per cent larger would.

A share of the friction is not it: below break-away the bristle hardly knows its level, and what an effect
adds there is nothing.
"""

import math

from tests.blind.sealer import rates as r_
from tests.blind.sealer import slots as p_
from tests.blind.sealer.compiled import compiled
from tests.blind.sealer.slots import Array

MORE = 1.01  # of a calibrated figure
SHADOWS = 6  # with the effects, without, and Tc, Ts, sigma_0, vs a little larger
WITH, WITHOUT, FIGURES = 0, 1, 2


@compiled
def level(omega: float, coulomb: float, stiction: float, stribeck: float, delta: float) -> float:
    """Steady bristle torque without any effect, N m."""
    fade = math.exp(-((abs(omega) / stribeck) ** delta))
    return coulomb + (stiction - coulomb) * fade


@compiled
def follow(z: float, h: float, omega: float, stiffness: float, g: float) -> float:
    """The bristle (rad) h seconds on, at this rate: the exact solution."""
    steady = math.copysign(g / stiffness, omega)
    return steady + (z - steady) * math.exp(-stiffness * abs(omega) / g * h)


@compiled
def shadow(h: float, s: Array, q: Array, p: Array, z: Array, e: Array, f: Array) -> None:
    """Advance the shadows z (SHADOWS,) by h seconds; what the effects add goes to e[0], what larger
    figures do to f (4,), N m."""
    omega, stiffness = s[1], p[p_.SIG0]
    tc, ts, vs, delta = p[p_.TC], p[p_.TS], p[p_.VS], p[p_.DELTA]
    z[WITH] = follow(z[WITH], h, omega, stiffness, r_.friction_level(omega, q, p))
    z[WITHOUT] = follow(z[WITHOUT], h, omega, stiffness, level(omega, tc, ts, vs, delta))
    z[2] = follow(z[2], h, omega, stiffness, level(omega, MORE * tc, ts, vs, delta))
    z[3] = follow(z[3], h, omega, stiffness, level(omega, tc, MORE * ts, vs, delta))
    z[4] = follow(z[4], h, omega, MORE * stiffness, level(omega, tc, ts, vs, delta))
    z[5] = follow(z[5], h, omega, stiffness, level(omega, tc, ts, MORE * vs, delta))
    plain = stiffness * z[WITHOUT]
    e[0] -= stiffness * z[WITH] - plain
    f[0], f[1] = stiffness * z[2] - plain, stiffness * z[3] - plain
    f[2], f[3] = MORE * stiffness * z[4] - plain, stiffness * z[5] - plain
