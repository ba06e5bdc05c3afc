"""Right-hand side of the drive: load, two trains with play, two one-way motors, LuGre bristle.

State s: 0 load angle, 1 load rate, 2/3 rotor A angle and rate, 4/5 rotor B, 6/7 currents, 8 bristle, 9/10
second mass.
Held values q (constant over a step): see the Q_ numbers.
"""

import math

from tests.blind.sealer import slots as p_
from tests.blind.sealer.compiled import compiled
from tests.blind.sealer.slots import Array

STATES = 11
Q_BREAKAWAY, Q_LEVEL, Q_VISCOUS, Q_COULOMB_ADD, Q_AXIS_TORQUE, Q_KIN_A, Q_KIN_B = range(7)
Q_TORQUE_A, Q_TORQUE_B, Q_VOLT_A, Q_VOLT_B, Q_KA, Q_KB, Q_RA, Q_RB, Q_KFA = range(7, 16)
HELD = 16


@compiled
def friction_level(omega: float, q: Array, p: Array) -> float:
    """Steady bristle torque g(omega), N m."""
    x = abs(omega) / p[p_.VS]
    fade = math.exp(-x * x) if p[p_.DELTA] == 2.0 else math.exp(-(x ** p[p_.DELTA]))
    coulomb = p[p_.TC]
    level = coulomb + (p[p_.TS] * q[Q_BREAKAWAY] - coulomb) * fade
    if omega > 0.0:
        level *= 1.0 + p[p_.ASYM_C]
    elif omega < 0.0:
        level *= 1.0 - p[p_.ASYM_C]
    level = level * q[Q_LEVEL] + q[Q_COULOMB_ADD]
    return float(max(level, 1.0))


@compiled
def tooth_force(gap: float, rate: float, p: Array) -> float:
    """Torque through one train at the axis, N m: nothing inside the play, spring and damper on a flank, no
    glue."""
    half = p[p_.HALF_GAP]
    if gap > half:
        return float(max(0.0, p[p_.KGEAR] * (gap - half) + p[p_.CGEAR] * rate))
    if gap < -half:
        return float(min(0.0, p[p_.KGEAR] * (gap + half) + p[p_.CGEAR] * rate))
    return 0.0


@compiled
def current_rate(volt: float, current: float, spin: float, k: float, r: float, p: Array) -> float:
    """A/s of a motor that can only pull: an aiding back-EMF counts only through a freewheel diode."""
    emf = k * spin if spin > 0.0 else k * spin * p[p_.DIODE]
    rate: float = (volt - r * current - emf) / p[p_.L]
    if current <= 0.0 and rate < 0.0:
        return 0.0
    return rate


@compiled
def derivative(s: Array, q: Array, p: Array, d: Array) -> None:
    """Write ds/dt into d."""
    ratio = p[p_.RATIO]
    omega = s[1]
    bristle_rate = omega - p[p_.SIG0] * abs(omega) / friction_level(omega, q, p) * s[8]
    viscous = p[p_.SIG2] * q[Q_VISCOUS]
    if omega > 0.0:
        viscous *= 1.0 + p[p_.ASYM_V]
    elif omega < 0.0:
        viscous *= 1.0 - p[p_.ASYM_V]
    friction = p[p_.SIG0] * s[8] + p[p_.SIG1] * bristle_rate + viscous * omega
    push_a = tooth_force(s[2] / ratio - s[0] - q[Q_KIN_A], s[3] / ratio - omega, p)
    push_b = tooth_force(s[4] / ratio - s[0] - q[Q_KIN_B], s[5] / ratio - omega, p)
    second = 0.0
    inertia = p[p_.J]
    d[9] = s[10]
    d[10] = 0.0
    if p[p_.J2] > 0.0:
        w = p[p_.W2]
        second = p[p_.J2] * (w * w * (s[9] - s[0]) + 2.0 * p[p_.Z2] * w * (s[10] - omega))
        inertia -= p[p_.J2]
        d[10] = -second / p[p_.J2]
    d[0] = omega
    d[1] = (push_a + push_b - friction + q[Q_AXIS_TORQUE] + second) / inertia
    d[2] = s[3]
    d[3] = (q[Q_KFA] * s[6] + q[Q_TORQUE_A] - push_a / ratio) / p[p_.JM]
    d[4] = s[5]
    d[5] = (-q[Q_KB] * s[7] + q[Q_TORQUE_B] - push_b / ratio) / p[p_.JM]
    d[6] = current_rate(q[Q_VOLT_A], s[6], s[3], q[Q_KA], q[Q_RA], p)
    d[7] = current_rate(q[Q_VOLT_B], s[7], -s[5], q[Q_KB], q[Q_RB], p)
    d[8] = bristle_rate


@compiled
def rk4(s: Array, h: float, q: Array, p: Array, k: Array, w: Array) -> None:
    """Classical Runge-Kutta step of h seconds in place; k (4, STATES) and w (STATES) are scratch."""
    derivative(s, q, p, k[0])
    for stage in range(1, 4):
        f = h if stage == 3 else 0.5 * h
        for i in range(STATES):
            w[i] = s[i] + f * k[stage - 1, i]
        derivative(w, q, p, k[stage])
    for i in range(STATES):
        s[i] += h / 6.0 * (k[0, i] + 2.0 * k[1, i] + 2.0 * k[2, i] + k[3, i])
    s[6] = max(s[6], 0.0)
    s[7] = max(s[7], 0.0)
