"""The declared model of the axis, fitted to the motion: inertia, LuGre friction, and what this log can tell
of them."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from calibration.channels.friction import bristle
from calibration.channels.motion import Motion
from calibration.readers.run import Array
from calibration.statistics.regression import solve
from calibration.statistics.whitening import Mask

BOUNDS = (
    (0.0, 3.2),
    (np.log(3e-6), np.log(1e-2)),
    (np.log(5e2), np.log(2e6)),
)  # log ratio, log vs, log sigma0/Tc


@dataclass
class Friction:
    """Nonlinear parameters of the bristle and the linear ones around them."""

    ratio: float  # Ts / Tc
    stribeck_speed: float  # rad/s
    stiffness: float  # sigma_0 / Tc, 1/rad
    coulomb: float
    viscous: float
    inertia: float
    inertia_fixed: bool = False
    identifiable: dict[str, bool] = field(default_factory=dict)


def shape_columns(m: Motion, p: Array, exponent: float = 2.0) -> Array:
    """Bristle shape (n,) at full rate for log parameters p = (log ratio, log vs, log stiffness)."""
    ratio, speed, stiffness = (float(np.exp(x)) for x in p)
    return bristle(m.theta, m.starts, _dt(m), ratio, speed, stiffness, exponent)


def _dt(m: Motion) -> float:
    return m.period_s / m.width


def linear_columns(m: Motion) -> Array:
    """Acceleration and rate on the analysis grid, the declared model's linear part."""
    return np.column_stack([m.acceleration[m.pick], m.rate[m.pick]])


def fit_friction(
    m: Motion, torque: Array, rows: Mask, start: Array, exponent: float, lines: Array
) -> tuple[Friction, Array, Array]:
    """Fit the declared model to `torque` (n_analysis,) on `rows`, from log parameters `start`. `lines`
    (n_analysis, k) are periodic torques that are declared too: left out, they would bend the friction.

    Returns the parameters, the base columns (acceleration, rate, bristle, its three log-derivatives times
    the Coulomb
    torque, and the bristle's rate for sigma_1), and the bristle at full rate.
    """
    from scipy.optimize import least_squares

    linear = linear_columns(m)
    sub = rows.copy()
    scale = float(np.std(torque[rows])) or 1.0

    def columns(p: Array) -> Array:
        return np.column_stack([linear, m.at(shape_columns(m, p, exponent)), lines])

    def left(p: Array) -> Array:
        x = columns(p)[sub]
        e = torque[sub] - x @ solve(x, torque[sub])
        prior = (
            (p - start) / np.array([1.5, 1.5, 3.0]) * 0.5
        )  # holds what the data leave open at the declared value
        return np.concatenate([e / scale, prior * 0.05])

    low, high = np.array([b[0] for b in BOUNDS]), np.array([b[1] for b in BOUNDS])
    best, roughness = None, float(np.std(np.diff(torque[sub], n=2))) / np.sqrt(6.0)
    for shift in ((0.0, 0.0, 0.0), (0.0, 0.0, -1.8), (-0.5, 0.7, 0.9)):
        begin = np.clip(start + np.array(shift), low + 1e-3, high - 1e-3)
        found = least_squares(
            left,
            begin,
            bounds=(low, high),
            loss="soft_l1",
            f_scale=0.05,
            x_scale=(0.3, 0.3, 0.5),
            diff_step=0.02,
            max_nfev=15,
        )
        if best is None or found.cost < best.cost:
            best = found
        if float(np.median(np.abs(left(best.x)[:-3]))) * scale < 2.0 * roughness:
            break  # what is left is mostly the sensors' noise: no better minimum to look for
    assert best is not None
    p = best.x
    for _ in range(POLISH):
        shape, base, beta = _linearised(m, p, linear, torque, sub, exponent, lines)
        e = np.abs(torque - base @ solve(base[sub], torque[sub]))
        inside = sub & (e < 6 * max(float(np.median(e[sub])), 1e-9))
        step = np.clip(solve(base[inside], torque[inside])[3:6], -0.3, 0.3)
        if not np.all(np.isfinite(step)) or np.abs(step).max() < 1e-4:
            break
        trial = np.clip(p + step, low + 1e-3, high - 1e-3)
        errors = [_median_error(m, q, linear, torque, sub, exponent, lines) for q in (trial, p)]
        if errors[0] > errors[1]:
            break
        p = trial
    shape, base, beta = _linearised(m, p, linear, torque, sub, exponent, lines)
    base = base[:, : base.shape[1] - lines.shape[1]]
    return (
        Friction(
            float(np.exp(p[0])),
            float(np.exp(p[1])),
            float(np.exp(p[2])),
            float(beta[2]),
            float(beta[1]),
            float(beta[0]),
        ),
        base,
        shape,
    )


POLISH = 6  # Gauss-Newton steps on the rows that the model already fits


def _linearised(
    m: Motion, p: Array, linear: Array, torque: Array, rows: Mask, exponent: float, lines: Array
) -> tuple[Array, Array, Array]:
    """Bristle at full rate, base columns with derivatives to the log parameters, coefficients of the first
    three; `lines` come last."""
    shape = shape_columns(m, p, exponent)
    x = np.column_stack([linear, m.at(shape), lines])
    beta = solve(x[rows], torque[rows])
    derivative = []
    for k in range(3):
        h = np.zeros(3)
        h[k] = 0.03
        derivative.append(
            m.at((shape_columns(m, p + h, exponent) - shape_columns(m, p - h, exponent)) / 0.06) * beta[2]
        )
    slip = np.zeros(len(shape))
    slip[1:-1] = (shape[2:] - shape[:-2]) / (2 * _dt(m)) / float(np.exp(p[2]))  # dz/dt of the bristle, rad/s
    slip[m.starts] = 0.0
    return shape, np.column_stack([x[:, :3], *derivative, m.at(slip), lines]), beta


def _median_error(
    m: Motion, p: Array, linear: Array, torque: Array, rows: Mask, exponent: float, lines: Array
) -> float:
    x = np.column_stack([linear, m.at(shape_columns(m, p, exponent)), lines])
    e = torque[rows] - x[rows] @ solve(x[rows], torque[rows])
    return float(np.mean(np.minimum(np.abs(e), 8 * np.median(np.abs(e)))))
