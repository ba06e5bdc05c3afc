"""One run of one drive: a sampled position loop around one or two masses with bristle friction."""

import math

import numpy as np

from tests.blind.drives import slots as p_
from tests.blind.drives.slots import Array
from tests.blind.sealer.compiled import compiled

SUBSTEPS = 8
STOPS = 6


@compiled
def friction(v: float, z: float, x: float, t: float, p: Array, own: Array) -> float:
    """Braking force; own[0] collects what the effects add."""
    way = v / (abs(v) + 0.02 * p[p_.VS])
    base = p[p_.SIG0] * z + p[p_.VISC] * v
    extra = p[p_.ASYM] * abs(way) + p[p_.POSF] * math.cos(p[p_.POSF_K] * x + p[p_.POSF_P]) * way
    if p[p_.DRAG] > 0.0 and t > p[p_.DRAG_T]:
        extra += p[p_.DRAG] * way
    if p[p_.WARM] != 0.0:
        extra += p[p_.WARM] * math.exp(-t / p[p_.WARM_TAU]) * way
    own[0] -= extra
    return base + extra


@compiled
def outside(x: float, v: float, memory: Array, p: Array) -> float:
    """Force of a Preisach loop: stops of different play, each pulling back."""
    if p[p_.PREISACH] == 0.0:
        return 0.0
    total = 0.0
    for k in range(STOPS):
        width = p[p_.PREISACH_W] * (0.3 + 0.5 * k)
        memory[k] = min(max(memory[k], x - width), x + width)
        total += (x - memory[k]) / width / STOPS
    return -p[p_.PREISACH] * total


@compiled
def simulate(p: Array, reference: Array, period: float, start_s: float, noise: Array, memory: Array) -> Array:
    """Rows (slots.COLUMNS) at every sample: effort, motor position and speed, load position, the effects'
    own force, motor acceleration. `reference` (n,) position; `noise` (n,) of the controller's reading."""
    n = reference.shape[0]
    rows = np.zeros((n, 6))
    h = period / SUBSTEPS
    x = x2 = reference[0]
    v = v2 = z = integral = 0.0
    before = x
    u = 0.0
    own = np.zeros(1)
    two = p[p_.STIFF] > 0.0
    for i in range(n):
        t = start_s + i * period
        seen = x + noise[i]
        error = reference[i] - seen
        speed = (seen - before) / period
        before = seen
        wanted = (reference[i] - reference[max(i - 1, 0)]) / period
        if p[p_.CASCADE] > 0.5:
            u = p[p_.KV] * (p[p_.KP] * error + wanted - speed)
        else:
            u = p[p_.KP] * error + p[p_.KD] * (wanted - speed)
        if abs(wanted) < p[p_.SCHEDULED_V]:
            u *= 1.0 - p[p_.SCHEDULED]
        integral += p[p_.KI] * error * period
        u = min(max(u + integral, -p[p_.TOP]), p[p_.TOP])
        upset = 0.0
        if p[p_.UPSET] > 0.0:
            upset = math.sin(2.0 * math.pi * p[p_.UPSET_F] * t)
            if p[p_.UPSET_SQUARE] > 0.5:
                upset = math.copysign(1.0, upset)
            upset *= p[p_.UPSET]
        if p[p_.UPSET_INSIDE] > 0.5:
            u += upset
            upset = 0.0
        sums = 0.0
        a = 0.0
        for _ in range(SUBSTEPS):
            own[0] = 0.0
            gain = 1.0
            if p[p_.BRUSH] > 0.0 and math.sin(p[p_.BRUSH_K] * x) > 0.8 and math.sin(1.7 * t) > 0.0:
                gain = 1.0 - min(p[p_.BRUSH], 1.0)
            push = p[p_.GAIN] * (u + upset) * gain
            own[0] += push - p[p_.GAIN] * u
            brake = friction(v, z, x, t, p, own)
            extra = p[p_.LINE] * math.cos(p[p_.LINE_K] * x + p[p_.LINE_P])
            extra -= p[p_.GRAV] * math.sin(x + p[p_.GRAV_P])
            extra += outside(x, v, memory, p)
            own[0] += extra
            coupling = 0.0
            if two:
                twist = x - x2
                half = 0.5 * p[p_.GAP]
                if abs(twist) > half:
                    coupling = p[p_.STIFF] * (twist - math.copysign(half, twist)) + p[p_.DAMP] * (v - v2)
                v2 += h * (coupling - 0.02 * p[p_.VISC] * v2) / p[p_.MASS2]
                x2 += h * v2
                own[0] -= coupling - p[p_.MASS2] * a
            a = (push - brake + extra - coupling) / p[p_.MASS]
            g = p[p_.COUL] + (p[p_.STIC] - p[p_.COUL]) * math.exp(-((v / p[p_.VS]) ** 2))
            v += h * a
            steady = math.copysign(g / p[p_.SIG0], v)
            z = steady + (z - steady) * math.exp(-p[p_.SIG0] * abs(v) / g * h)
            x += h * v
            sums += own[0]
        if not two:
            x2 = x
        rows[i, 0], rows[i, 1], rows[i, 2] = u, x, v
        rows[i, 3], rows[i, 4], rows[i, 5] = x2, sums / SUBSTEPS, a
    return rows
