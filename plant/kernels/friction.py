"""LuGre friction with the exact bristle update (paper, equations (3) to (5); errors in print corrected).

T = sigma0 z + sigma1 dz/dt + sigma2 w,  dz/dt = w - |w| z / g(w),
sigma0 g(w) = Tc + (Ts - Tc) exp(-(|w| / ws)^delta).
For constant w the bristle relaxes exponentially, so its update is exact for any step (no |w| dt / g limit).
"""

from math import exp

from plant.compiled import inner
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
def stribeck(rate, f):  # type: ignore[no-untyped-def]
    """Return g(rate), rad: the bristle deflection of steady sliding."""
    x = abs(rate) / f[F_RATE]
    if f[F_EXPONENT] == 2.0:
        x = x * x
    elif f[F_EXPONENT] != 1.0:
        x = x ** f[F_EXPONENT]
    level = f[F_COULOMB]
    if x < NEGLIGIBLE:
        level += (f[F_STICTION] - level) * exp(-x)
    return level / f[F_SIGMA0]


@inner
def damping(rate, f):  # type: ignore[no-untyped-def]
    """Return sigma1, N m s/rad, decayed with the rate when a decay rate is given (> 0)."""
    if f[F_DECAY] > 0.0:
        x = rate / f[F_DECAY]
        return f[F_SIGMA1] * exp(-x * x)
    return f[F_SIGMA1]


@inner
def torque(rate, z, g, f):  # type: ignore[no-untyped-def]
    """Return the friction torque, N m, against the motion."""
    flow = rate - abs(rate) * z / g
    return f[F_SIGMA0] * z + damping(rate, f) * flow + f[F_SIGMA2] * rate


@inner
def relax(z, rate, g, dt):  # type: ignore[no-untyped-def]
    """Return the bristle deflection after `dt` at constant rate: exact."""
    if rate == 0.0:
        return z
    goal = g if rate > 0.0 else -g
    return goal + (z - goal) * exp(-abs(rate) * dt / g)


@inner
def steady(rate, f):  # type: ignore[no-untyped-def]
    """Return the torque of steady sliding at `rate`, N m, signed."""
    if rate == 0.0:
        return 0.0
    level = stribeck(rate, f) * f[F_SIGMA0]
    return (level if rate > 0.0 else -level) + f[F_SIGMA2] * rate
