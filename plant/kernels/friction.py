"""LuGre friction with the exact bristle update (paper, equations (3) to (5); errors in print corrected).

T = sigma0 z + sigma1 dz/dt + sigma2 w;  dz/dt = w - |w| z / g(w);

sigma0 g(w) = Tc + (Ts - Tc) exp(-(|w| / ws)^delta).
The parameters are eight numbers of an array `w` from place `f` on (layout.F_*). For a constant rate the
bristle relaxes exponentially, so its update is exact for any step (no |w| dt / g limit).
"""

from math import exp

from plant.compiled import Floats, inner
from plant.kernels.layout import (
    F_COULOMB,
    F_DECAY,
    F_EXPONENT,
    F_RATE,
    F_SIGMA0,
    F_SIGMA1,
    F_SIGMA2,
    F_STICTION,
)

NEGLIGIBLE = 40.0  # exp(-40) is below the resolution of the sum it enters


@inner
def stribeck(rate: float, w: Floats, f: int) -> float:
    """Return g(rate), rad: the bristle deflection of steady sliding."""
    x = abs(rate) / w[f + F_RATE]
    if w[f + F_EXPONENT] == 2.0:
        x = x * x
    elif w[f + F_EXPONENT] != 1.0:
        x = x ** w[f + F_EXPONENT]
    level = w[f + F_COULOMB]
    if x < NEGLIGIBLE:
        level += (w[f + F_STICTION] - level) * exp(-x)
    return level / w[f + F_SIGMA0]


@inner
def damping(rate: float, w: Floats, f: int) -> float:
    """Return sigma1, N m s/rad, decayed with the rate when a decay rate is given (> 0)."""
    if w[f + F_DECAY] > 0.0:
        x = rate / w[f + F_DECAY]
        return w[f + F_SIGMA1] * exp(-x * x)
    return w[f + F_SIGMA1]


@inner
def torque(rate: float, z: float, g: float, w: Floats, f: int) -> float:
    """Return the friction torque, N m, against the motion."""
    flow = rate - abs(rate) * z / g
    return w[f + F_SIGMA0] * z + damping(rate, w, f) * flow + w[f + F_SIGMA2] * rate


@inner
def relax(z: float, rate: float, g: float, dt: float) -> float:
    """Return the bristle deflection after `dt` at constant rate: exact."""
    if rate == 0.0:
        return z
    goal = g if rate > 0.0 else -g
    return goal + (z - goal) * exp(-abs(rate) * dt / g)


@inner
def steady(rate: float, w: Floats, f: int) -> float:
    """Return the torque of steady sliding at `rate`, N m, signed."""
    if rate == 0.0:
        return 0.0
    level = stribeck(rate, w, f) * w[f + F_SIGMA0]
    return (level if rate > 0.0 else -level) + w[f + F_SIGMA2] * rate
