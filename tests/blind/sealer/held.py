"""Everything that is held over one step: what the effects add, and the trace of their own contribution.

Own contribution e: 0 torque N m, 1 kinematic arcsec, 2 volts A, 3 volts B (the roller's is taken in the
loop).
Memory m of the slow elements: 0/1 heat of the motors (K), 2 cable loop (rad), 3.. six stops of the
hysteresis (rad).
"""

import math

from tests.blind.sealer import rates as r_
from tests.blind.sealer import slots as p_
from tests.blind.sealer.compiled import compiled
from tests.blind.sealer.slots import Array

STOPS = 6
MEMORY = 3 + STOPS
COPPER = 0.0039  # 1/K, temperature coefficient of copper
PER_ARCSEC = math.pi / 648000.0


@compiled
def onset(t: float, t0: float, ramp: float) -> float:
    """0 before t0, 1 after; linear over ramp seconds when ramp > 0."""
    if t < t0:
        return 0.0
    return 1.0 if ramp <= 0.0 else min(1.0, (t - t0) / ramp)


@compiled
def tooth_pulse(turns: float, width: float) -> float:
    """Raised cosine of `width` turns once per turn, 0..1."""
    x = turns - math.floor(turns)
    return 0.5 - 0.5 * math.cos(2.0 * math.pi * x / width) if x < width else 0.0


@compiled
def friction_effects(p: Array) -> bool:
    """Whether any friction effect is on (most cases have none, and this is in the inner loop)."""
    total = abs(p[p_.ASYM_C]) + abs(p[p_.ASYM_V]) + abs(p[p_.POSF_A]) + abs(p[p_.LOADF])
    total += abs(p[p_.WARM_A]) + abs(p[p_.PRELOAD_A]) + abs(p[p_.BRAKE_T])
    return bool(total > 0.0)


@compiled
def sine(on: float, order: float, angle: float, phase: float) -> float:
    """sin(order * angle + phase), or 0 when its amplitude `on` is 0."""
    return math.sin(order * angle + phase) if on != 0.0 else 0.0


@compiled
def hold_friction(t: float, s: Array, q: Array, p: Array, e: Array) -> None:
    """Levels of friction: warm-up, preload, position, load, brake; what viscous ones add."""
    q[r_.Q_BREAKAWAY] = q[r_.Q_VISCOUS] = q[r_.Q_LEVEL] = 1.0
    q[r_.Q_COULOMB_ADD] = 0.0
    if not friction_effects(p):
        return
    load = p[p_.RATIO] * (p[p_.KA] * s[6] + p[p_.KB] * s[7])
    warm = p[p_.WARM_A] * math.exp(-t / p[p_.WARM_TAU]) if p[p_.WARM_A] != 0.0 else 0.0
    pre = p[p_.PRELOAD_A] * onset(t, p[p_.PRELOAD_T0], p[p_.PRELOAD_RAMP])
    q[r_.Q_BREAKAWAY] = 1.0 + pre
    q[r_.Q_VISCOUS] = 1.0 + pre
    q[r_.Q_LEVEL] = 1.0 + warm
    add = p[p_.LOADF] * load + p[p_.BRAKE_T] * onset(t, p[p_.BRAKE_T0], 0.0)
    add += p[p_.POSF_A] * math.sin(p[p_.POSF_ORDER] * s[0] + p[p_.POSF_PH])
    q[r_.Q_COULOMB_ADD] = add
    sign = 1.0 if s[1] > 0.0 else -1.0
    e[0] -= p[p_.SIG2] * s[1] * (pre + sign * p[p_.ASYM_V])


@compiled
def hold_axis(s: Array, m: Array, extra: float, q: Array, p: Array, e: Array) -> None:
    """Torques and kinematic errors over the angles."""
    theta = s[0]
    torque = (
        extra
        + p[p_.GRAV_A] * sine(p[p_.GRAV_A], 1.0, theta, 0.5 * math.pi - p[p_.GRAV_PH])
        - p[p_.QUAD] * s[1] * abs(s[1])
    )
    torque -= p[p_.CABLE_K] * (theta - p[p_.CABLE_TH0])
    if p[p_.CABLE_H] != 0.0:
        torque -= p[p_.CABLE_H] * m[2] / p[p_.CABLE_SCALE]
    for i in range(STOPS):
        if p[p_.PREI_A] != 0.0:
            torque -= p[p_.PREI_A] / STOPS * m[3 + i] / (p[p_.PREI_W] * (i + 1) / STOPS)
    one = sine(p[p_.L1_T], p[p_.L1_ORDER], theta, p[p_.L1_PH])
    two = sine(p[p_.L2_T], p[p_.L2_ORDER], theta, p[p_.L2_PH])
    tooth = 0.0
    if p[p_.TOOTH_WIDTH] > 0.0:
        tooth = tooth_pulse(p[p_.TOOTH_ORDER] * theta / (2.0 * math.pi) + p[p_.TOOTH_PH], p[p_.TOOTH_WIDTH])
    torque += p[p_.L1_T] * one + p[p_.L2_T] * two + p[p_.TOOTH_T] * tooth
    kin = p[p_.L1_K] * one + p[p_.L2_K] * two + p[p_.TOOTH_K] * tooth
    q[r_.Q_AXIS_TORQUE] = torque
    q[r_.Q_KIN_A] = kin
    q[r_.Q_KIN_B] = 0.0
    e[0] += torque
    e[1] += kin / PER_ARCSEC


@compiled
def hold_motors(
    t: float, burst: float, s: Array, m: Array, duty: Array, q: Array, p: Array, e: Array
) -> None:
    """Voltages, resistances, constants, cogging and drag of the two motors."""
    ratio = p[p_.RATIO]
    lost = p[p_.MAG_A] * onset(t, p[p_.MAG_T0], p[p_.MAG_RAMP])
    for side in range(2):
        k0 = p[p_.KA + side]
        r0 = p[p_.RA + side]
        current = s[6 + side]
        spin = s[3] if side == 0 else -s[5]
        live = max(0.0, duty[side] - p[p_.DEADBAND])
        supply = p[p_.V0] - p[p_.SAG] * (s[6] + s[7])
        k = k0 * (1.0 - lost) if p[p_.MAG_SIDE] == 0.0 or p[p_.MAG_SIDE] == side + 1.0 else k0
        res = r0 * (1.0 + COPPER * m[side])
        if side == 0 and burst > 0.0 and p[p_.BRUSH_A] > 0.0:
            x = (s[2] - p[p_.BRUSH_PH]) / (2.0 * math.pi)
            if x - math.floor(x) < p[p_.BRUSH_WIDTH]:
                res += p[p_.BRUSH_A]
        volt = live * supply
        q[r_.Q_VOLT_A + side] = volt
        q[r_.Q_KA + side] = k
        q[r_.Q_RA + side] = res
        e[2 + side] += volt - duty[side] * p[p_.V0] - (res - r0) * current + (k0 - k) * max(spin, 0.0)
        if p[p_.DIODE] > 0.0 and spin < 0.0 and duty[side] > 0.0:
            e[2 + side] -= p[p_.DIODE] * k * spin
        sign = ratio if side == 0 else -ratio
        e[0] += sign * (k - k0) * current
        if (
            p[p_.DIODE] > 0.0 and duty[side] <= 0.0
        ):  # the open switch hides this current from the sense resistor
            e[0] += sign * k * current
    wave = sine(p[p_.RIP_A], p[p_.RIP_N], s[2], p[p_.RIP_PH])
    q[r_.Q_KFA] = q[r_.Q_KA] * (1.0 + p[p_.RIP_A] * wave)
    cog = p[p_.COG_A] * sine(p[p_.COG_A], p[p_.COG_N], s[2], p[p_.COG_PH])
    e[0] += ratio * (cog + (q[r_.Q_KFA] - q[r_.Q_KA]) * s[6])
    q[r_.Q_TORQUE_A] = cog
    q[r_.Q_TORQUE_B] = 0.0
    if p[p_.ROTOR_DRAG] > 0.0:  # the lagging train's own friction
        lag = 1 if duty[0] >= duty[1] else 0
        drag = -p[p_.ROTOR_DRAG] * math.tanh(s[3 + 2 * lag] / 0.02)
        q[r_.Q_TORQUE_A + lag] += drag
        e[0] += ratio * drag


@compiled
def remember(h: float, move: float, s: Array, m: Array, p: Array) -> None:
    """Advance the slow elements by h seconds and `move` rad of axis travel."""
    if p[p_.HEAT] > 0.0:
        for side in range(2):
            watt = p[p_.RA + side] * s[6 + side] * s[6 + side]
            m[side] += h * (p[p_.HEAT] * watt - m[side]) / p[p_.HEAT_TAU]
    if p[p_.CABLE_H] != 0.0:
        m[2] = min(p[p_.CABLE_SCALE], max(-p[p_.CABLE_SCALE], m[2] + move))
    if p[p_.PREI_A] != 0.0:
        for i in range(STOPS):
            width = p[p_.PREI_W] * (i + 1) / STOPS
            m[3 + i] = min(width, max(-width, m[3 + i] + move))
