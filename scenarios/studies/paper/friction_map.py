"""Torque over velocity from steady runs, the static LuGre curve through it (paper, Fig. 8, Table 2)."""

from collections.abc import Sequence
from dataclasses import astuple, dataclass

import numpy as np
from scipy.optimize import least_squares

from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.runs import BROKEN_AWAY
from scenarios.studies.paper.scales import ADC_A_PER_COUNT, ARCSEC, EFFORT_SCALE, GEAR_RATIO, Drive


@dataclass(frozen=True)
class MapPoint:
    """One steady state. rate: rad/s at the axis. torque: N m at the axis. spread: standard error of it, N m:
    what the fit weights it by. unrest: the same from its wander within the run, gears included."""

    rate: float
    torque: float
    spread: float
    unrest: float = 0.0


def ripple_free(log: Log, sheet: Drive) -> tuple[Array, Array]:
    """Return the mean currents of motors A and B, A.

    The converter samples at the falling edge of the PWM, "where the motor current peaks" (paper 3.3). Half
    the ripple, V D (1 - D) / (2 L f), is known from the duty and taken off.
    """
    lead = np.abs(log.effort) / EFFORT_SCALE
    lag = lead * sheet.split
    forward = log.effort >= 0.0

    def mean(current: Array, duty: Array) -> Array:
        return np.asarray(np.maximum(0.0, current - sheet.ripple * duty * (1.0 - duty)), dtype=np.float64)

    return (
        mean(log.current_a, np.where(forward, lead, lag)),
        mean(log.current_b, np.where(forward, lag, lead)),
    )


def drive_torque(log: Log, sheet: Drive) -> Array:
    """Return what the two motors give at the axis, N m, from the measured currents. B pulls against A."""
    a, b = ripple_free(log, sheet)
    return np.asarray((a - b) * sheet.torque_constant * GEAR_RATIO, dtype=np.float64)


def over_angle(log: Log) -> Array:
    """Return each sample's share of the angle that a run covers.

    What the gears add repeats with the angle, so its mean over whole turns is zero over the angle. Over time
    it is not: an open loop lingers where they hold it back (0.2 % of the torque at 5 % of ripple).
    """
    summed, rows = (np.convolve(x, np.ones(WINDOW), mode="same") for x in (log.rate, np.ones(log.rate.size)))
    rate = summed / rows
    covered = np.maximum(0.0, rate * np.sign(rate.sum()))
    whole = float(covered.sum())
    share = covered / whole if whole > 0.0 else np.full(rate.size, 1.0 / rate.size)
    return np.asarray(share, dtype=np.float64)


def steady_point(forward: Log, backward: Log, sheet: Drive) -> MapPoint:
    """Return the mean torque and rate of two steady runs over the angle, there and back. Without acceleration
    half the difference of the drive torques is the friction, whatever the balance of the axis adds to both.

    The standard error is that of white noise and the converter. Over whole half turns the gears' part is no
    error, though it is most of what the torque does within a run.
    """
    torque, rate, noise, unrest = [], [], [], []
    for log in (forward, backward):
        driven, share = drive_torque(log, sheet), over_angle(log)
        blocks = [part.mean() for part in np.array_split(driven, 10)]
        torque.append(float(share @ driven))
        rate.append(float(share @ log.rate))
        noise.append(float(np.std(np.diff(driven)) / np.sqrt(2.0 * driven.size)))
        unrest.append(float(np.std(blocks, ddof=1) / np.sqrt(10.0)))
    # a steady current rests anywhere within the converter's step, and averaging does not help
    converter = np.sqrt(2.0 / 12.0) * ADC_A_PER_COUNT * sheet.torque_constant * GEAR_RATIO
    return MapPoint(
        (rate[0] - rate[1]) / 2.0 * ARCSEC,
        (torque[0] - torque[1]) / 2.0,
        float(np.hypot(np.hypot(noise[0], noise[1]), np.sqrt(2.0) * converter) / 2.0),
        float(np.hypot(np.hypot(unrest[0], unrest[1]), np.sqrt(2.0) * converter) / 2.0),
    )


def break_away_point(forward: Log, backward: Log, sheet: Drive) -> MapPoint:
    """Return the largest torque before the axis breaks away, and the rate at which it crept then.

    forward, backward: effort rising from rest, either way. Both are means over the same WINDOW samples:
    against the converter's steps and the encoder's, and because the rate grows fast by then. Friction that is
    ramped up slowly follows the static curve, so this is a point of the map like the others.
    """
    found = []
    window = np.full(WINDOW, 1.0 / WINDOW)
    for log, sign in ((forward, 1.0), (backward, -1.0)):
        free = np.nonzero(sign * log.counts > BROKEN_AWAY)[0]
        held = slice(0, max(WINDOW, int(free[0]) if free.size else log.t_s.size))
        driven = sign * drive_torque(log, sheet)[held]
        torque = np.convolve(driven, window, mode="valid")
        rate = np.convolve(sign * log.rate[held], window, mode="valid")
        top = int(np.argmax(torque))
        found.append((float(rate[top]), float(torque[top])))
    rate, level = (sum(values) / 2.0 for values in zip(*found, strict=True))
    return MapPoint(max(rate, 0.1) * ARCSEC, level, BREAK_AWAY_ERROR * level)


WINDOW = 15  # Samples, 150 ms.
BREAK_AWAY_ERROR = 0.025
"""Share. The rate, some 10 arcsec/s, doubles within the window and is read in counts of 2.3. So it is known
to a quarter. There the torque falls by a tenth when the rate doubles (Table 2, any exponent near 0.5).
ASSUMPTION."""


def friction_curve(rate: Array, parameters: Sequence[float] | Array) -> Array:
    """Return Tc + (Ts - Tc) exp(-(w/vs)^delta) + sigma2 w, N m; paper, equations (3) and (5) at steady state.

    rate: rad/s, > 0. parameters: Tc, Ts (N m), vs (rad/s), delta, sigma2 (N m s/rad).
    """
    coulomb, stiction, stribeck_rate, exponent, viscous = parameters
    fall = np.exp(-((np.abs(rate) / stribeck_rate) ** exponent))
    return np.asarray(coulomb + (stiction - coulomb) * fall + viscous * np.abs(rate), dtype=np.float64)


@dataclass(frozen=True)
class FrictionFit:
    """Fitted Table 2 (SI at the axis) with the shape exponent."""

    coulomb: float
    stiction: float
    stribeck_rate: float
    exponent: float
    viscous: float

    def torque(self, rate: Array) -> Array:
        """Return the fitted friction, N m, at rates in rad/s."""
        return friction_curve(rate, astuple(self))


EXPONENTS = (0.5, 2.0)  # Bounds of the fitted exponent: hardware.md 1.1.


def fit_friction(points: Sequence[MapPoint], exponent: float | None = None) -> FrictionFit:
    """Fit Table 2's four parameters and the exponent (unless it is given) to a torque-velocity map, by least
    squares weighted with each point's standard error.

    Starts are a grid over vs and delta, so that the result does not depend on a guess. Raises ValueError when
    there are fewer points than parameters.
    """
    if len(points) < 6:
        raise ValueError(f"a torque-velocity map needs at least 6 steady points, not {len(points)}")
    rate = np.array([p.rate for p in points])
    torque = np.array([p.torque for p in points])
    spread = np.array([p.spread for p in points])
    bounds = EXPONENTS if exponent is None else (exponent * (1.0 - 1e-6), exponent * (1.0 + 1e-6))

    def misfit(x: Array) -> Array:
        return np.asarray((friction_curve(rate, np.exp(x)) - torque) / spread, dtype=np.float64)

    low = np.log([1.0, 1.0, 1e-5, bounds[0], 1.0])
    high = np.log([1e5, 1e5, 1e-1, bounds[1], 1e6])
    rise = np.ptp(torque[-3:]) / np.ptp(rate[-3:])
    found = []
    for vs in (2e-4, 5e-4, 1.2e-3):
        for delta in (0.6, 1.0, 1.8) if exponent is None else (exponent,):
            start = np.log([torque.min(), torque.max(), vs, delta, max(10.0, rise)])
            start = np.clip(start, low + 1e-9, high - 1e-9)
            found.append(least_squares(misfit, start, bounds=(low, high), loss="soft_l1"))
    return FrictionFit(*map(float, np.exp(min(found, key=lambda each: each.cost).x)))
