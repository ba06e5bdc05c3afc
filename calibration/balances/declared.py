"""The declared model of an axis, fitted to the motion: inertia, LuGre friction, declared periodic torques."""

from dataclasses import dataclass

import numpy as np

from calibration.arrays import Array, Mask
from calibration.balances.friction import Sliding, path_of, slid_by
from calibration.balances.motion import Motion
from calibration.inputs.declaration import FrictionLaw
from calibration.statistics.regression import solve

# What is fitted by iteration: the logs of Ts/Tc, of the Stribeck speed in rad/s, of sigma_0/Tc in 1/rad. The
# numbers below are ASSUMPTIONS, wide about both axes of the paper, and go by these three.
LOWEST = np.array([0.0, np.log(3e-6), np.log(5e2)])
HIGHEST = np.array([3.2, np.log(1e-2), np.log(2e6)])
# spread of the declared values, and weight of a residual beside the torque's
SPREAD, HOLD = np.array([3.0, 3.0, 6.0]), 0.05
# decades, natural, from the declared values, where a search begins. ASSUMPTION
STARTS = ((0.0, 0.0, 0.0), (0.0, 0.0, -1.8), (-0.5, 0.7, 0.9))
SCALES = (0.3, 0.3, 0.5)  # factor: steps of the logs that change as much. ASSUMPTION
INSIDE = 1e-3  # natural decades from the bounds. ASSUMPTION
SEARCH = {"loss": "soft_l1", "f_scale": 0.05, "x_scale": SCALES, "diff_step": 0.02, "max_nfev": 15}
POLISH = 6  # Gauss-Newton steps on the rows that the model already fits. ASSUMPTION
FITS = 6.0  # times the median residual, within which it fits them. ASSUMPTION
LONGEST = 0.3  # natural decades of such a step at most. ASSUMPTION
SHORTEST = 1e-4  # likewise of one that is no step any more. ASSUMPTION
APART = 0.03  # natural decades either way, for a derivative. ASSUMPTION
OUTLIER = 8.0  # times the median residual: more does not count. ASSUMPTION


def _logs(law: FrictionLaw) -> Array:
    return np.log(list(law.numbers.values()))


def _law(logs: Array, exponent: float) -> FrictionLaw:
    ratio, speed, stiffness = np.exp(logs).tolist()
    return FrictionLaw(
        stiction_ratio=ratio, stribeck_speed=speed, stribeck_exponent=exponent, bristle_travel=1 / stiffness
    )


@dataclass(frozen=True, kw_only=True)
class _Fit:
    """`torque` (n_analysis,) on `rows`, beside `lines` (n_analysis, k)."""

    motion: Motion
    torque: Array
    rows: Mask
    exponent: float
    lines: Array

    def bristle(self, logs: Array) -> Array:
        """Over Coulomb's (n,) at full rate."""
        return path_of(self.motion).bristle(_law(logs, self.exponent))

    def columns(self, bristle: Array) -> Array:
        """Acceleration, rate, bristle and lines (n_analysis, 3 + k)."""
        m = self.motion
        return np.column_stack([m.acceleration[m.rows], m.speed[m.rows], m.at(bristle), self.lines])

    def left(self, logs: Array) -> Array:
        """Residual on the rows."""
        x = self.columns(self.bristle(logs))[self.rows]
        return np.asarray(self.torque[self.rows] - x @ solve(x, self.torque[self.rows]))

    def error(self, logs: Array) -> float:
        """Mean size of the residual; outliers count as OUTLIER medians."""
        e = np.abs(self.left(logs))
        return float(np.mean(np.minimum(e, OUTLIER * np.median(e))))

    def linearised(self, logs: Array) -> tuple[Sliding, Array]:
        """Friction; columns, behind the bristle's its derivatives to the logs and sigma_1's, lines last."""
        m, shape = self.motion, self.bristle(logs)
        x = self.columns(shape)
        _, viscous, coulomb, *_ = (float(b) for b in solve(x[self.rows], self.torque[self.rows]))
        derivative = [
            m.at((self.bristle(logs + h) - self.bristle(logs - h)) / (2 * APART)) * coulomb
            for h in APART * np.eye(len(logs))
        ]
        friction = slid_by(m, _law(logs, self.exponent), coulomb, viscous)
        slip = np.zeros(len(shape))  # rad/s
        slip[1:-1] = (shape[2:] - shape[:-2]) / (2 * m.period_s) / friction.law.numbers["sigma_0"]
        slip[m.starts] = 0.0
        return friction, np.column_stack([x[:, :3], *derivative, m.at(slip), self.lines])

    def searched(self, start: Array) -> Array:
        """Logs that leave least, held at the declared ones (`start`) where the data leave them open."""
        from scipy.optimize import least_squares

        torque = self.torque[self.rows]
        scale = float(np.std(torque)) or 1.0

        def residual(logs: Array) -> Array:
            return np.concatenate([self.left(logs) / scale, (logs - start) / SPREAD * HOLD])

        begins = (np.clip(start + shift, LOWEST + INSIDE, HIGHEST - INSIDE) for shift in np.array(STARTS))
        tried = (least_squares(residual, x, bounds=(LOWEST, HIGHEST), **SEARCH) for x in begins)
        return np.asarray(min(tried, key=lambda found: found.cost).x)

    def polished(self, logs: Array) -> Array:
        """The same after Gauss-Newton steps on the rows that fit."""
        for _ in range(POLISH):
            _, base = self.linearised(logs)
            e = np.abs(self.torque - base @ solve(base[self.rows], self.torque[self.rows]))
            inside = self.rows & (e < FITS * max(float(np.median(e[self.rows])), 1e-9))
            _, _, _, *steps = solve(base[inside], self.torque[inside])
            step = np.clip(steps[: len(logs)], -LONGEST, LONGEST)
            if not np.all(np.isfinite(step)) or np.abs(step).max() < SHORTEST:
                break
            trial = np.clip(logs + step, LOWEST + INSIDE, HIGHEST - INSIDE)
            if self.error(trial) > self.error(logs):
                break
            logs = trial
        return logs


def fit_friction(
    m: Motion, torque: Array, rows: Mask, declared: FrictionLaw, lines: Array
) -> tuple[Sliding, Array]:
    """Fit the declared model to `torque` (n_analysis,) on `rows`, from the `declared` law. `lines`
    (n_analysis, k) are periodic torques that are declared too: left out, they would bend the friction.

    Returns the friction and the base columns: acceleration, rate, bristle, its three log-derivatives times
    the Coulomb torque, and the bristle's rate for sigma_1.
    """
    fit = _Fit(motion=m, torque=torque, rows=rows, exponent=declared.stribeck_exponent, lines=lines)
    friction, base = fit.linearised(fit.polished(fit.searched(_logs(declared))))
    return friction, base[:, : base.shape[1] - lines.shape[1]]
