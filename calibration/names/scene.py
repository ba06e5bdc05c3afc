"""What a name sees of a log: the columns at full rate, the balance, and its declared part."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calibration.arrays import Array, Mask
from calibration.balances.friction import Sliding, sliding_of
from calibration.balances.motion import acceleration_of, rate_of
from calibration.balances.problem import Problem
from calibration.balances.view import View
from calibration.balances.volts import Windings
from calibration.names.pair import Pair
from calibration.statistics.regression import solve

FEWEST = 0.005  # share of the rows that must lie within a gap, a loop or a dip. ASSUMPTION
# of a mean speed or load, its standard deviation: below, what grows with it is the constant one. ASSUMPTION
VARIES = 0.1
LEAST_K = 0.5  # of temperature, before a coefficient of it means anything. ASSUMPTION

#: kinds of balance that a name can be seen in: forces, two sensors, volts; of an axis with two motors also
#: the roller's rate against the axis', on the analysis grid and at the log's full rate; a speed by itself
FORCE, SENSORS, VOLTS, RATES, FULL_RATES = "force", "sensors", "volts", "rates", "full_rates"
SPEED = "speed"
KINDS = {"T": FORCE, "K": SENSORS, "E": VOLTS, "S": RATES}
MOTOR = "1 A, 2 B"  # a parameter that says which motor it is


def since_first(t: Array, label: NDArray[Any]) -> Array:
    """Time (n,) since the first row of the same label."""
    out = t.copy()
    for k in np.unique(label):
        out[label == k] -= t[label == k].min()
    return out


@dataclass
class Scene:
    """`declared` are the fitted coefficients of the balance's base by name. `residual` (n_fitted,) is what a
    flexible fit leaves, for the search of lines. `wander` are the columns of that flexible fit."""

    view: View
    problem: Problem
    declared: dict[str, float]
    residual: Array
    wander: Array
    model: Array | None = None  # (n_fitted,) the response with all that is named, once that is known
    pair: Pair | None = None  # of an axis with two motors
    windings: Windings | None = None  # of a balance of volts

    @property
    def unit(self) -> str:
        """Of the balance."""
        return self.view.unit

    @property
    def angle_unit(self) -> str:
        """Of the position."""
        return self.view.angle_unit

    @property
    def turn(self) -> float:
        """Position units per turn, 1 of a position that has none."""
        return self.view.turn or 1.0

    @property
    def force(self) -> bool:
        """True for a balance of forces."""
        return self.view.response.is_force

    @property
    def channel(self) -> str:
        """Kind of the balance, of KINDS."""
        kind = SPEED if self.view.response.is_speed else KINDS[self.problem.channel]
        return FULL_RATES if kind == RATES and self.pair and self.pair.motion.width == 1 else kind

    @property
    def rates(self) -> bool:
        """True for rates of two encoders on one shaft, False for places, forces and volts."""
        return self.channel in (RATES, FULL_RATES)

    @property
    def motors(self) -> list[tuple[Array, dict[str, tuple[float, str]]]]:
        """1 on the rows (n_fitted,) of each motor, and the parameter that says which; of one motor none."""
        if self.pair is None or self.pair.motor is None:
            return [(np.ones(len(self.problem.y)), {})]
        return [((self.pair.motor == k).astype(float), {"motor": (k + 1.0, MOTOR)}) for k in (0, 1)]

    def at(self, full: Array) -> Array:
        """Full-rate column(s) on the fitted rows; where rates are compared, the rates of errors of place."""
        if not self.rates or self.pair is None:
            return self.view.at(full)
        m, step_s = self.pair.motion, self.view.period_s
        bent = acceleration_of(full, m.width, step_s)
        # the roller's lags, which the base makes of the absolute encoder's acceleration and jerk, see an
        # error of that encoder, too
        late = self.declared["velocity_delay"] * bent
        late += self.declared["window_curvature"] * np.gradient(bent, step_s, axis=0)
        return np.asarray((rate_of(full, m.width, step_s) + late)[m.rows])

    @cached_property
    def sliding(self) -> Sliding:
        """The declared friction along the motion, of size 1 where none is declared."""
        if self.pair is not None and self.pair.sliding is not None:
            return self.pair.sliding
        c, v = (max(self.declared.get(n, 0.0), 0.0) for n in ("coulomb", "viscous"))
        return sliding_of(self.view, c if c > 0 or v > 0 else 1.0, v)

    def answer(self, change: Array) -> Array:
        """What friction answers, (n_fitted,), to a change (n,) of its level, which has no sign."""
        return self.at(self.sliding.answer(change))

    @property
    def clocks(self) -> dict[str, Array]:
        """Times (n,) s that an effect may begin by, by its start's name: all files' clock, each file's.

        Files without a declared clock may have been given in any order: a time among them is none.
        """
        v = self.view
        shared = {} if v.in_order else {"start": v.clock - v.clock.min()}
        return shared | ({"start_in_run": since_first(v.t, v.file)} if len(np.unique(v.file)) > 1 else {})

    @cached_property
    def zeros(self) -> list[tuple[list[Mask], bool]]:
        """Rows (n_fitted,) that share the position's zero, and whether each such part has a zero of its own.
        Files that are not declared to share it may do so, or not: both are tried."""
        own = self.problem.session
        files = [own == k for k in np.unique(own)]
        shared = [([np.ones(len(own), bool)], False)]
        if self.view.rig.runs.get("origin") == "shared" or len(files) < 2:
            return shared
        return [*shared, (files, True)]

    @property
    def both(self) -> bool:
        """True when the drive goes both ways."""
        return self.view.both

    @property
    def temperature(self) -> Array | None:
        """At full rate, where it changes by enough for a coefficient to mean anything."""
        t = self.view.columns.get("temperature")
        return t if t is not None and np.ptp(t) > LEAST_K else None

    @property
    def speeds(self) -> bool:
        """True when the speed, whatever its direction, varies."""
        speed = np.abs(self.view.speed)
        return bool(np.std(speed) > VARIES * np.mean(speed))

    @property
    def span(self) -> float:
        """Travel, position units."""
        x = self.view.x[self.view.ok]
        return float(np.ptp(x)) if len(x) else 0.0

    @property
    def declared_part(self) -> Array:
        """The response (n_fitted,) as the declared terms have it."""
        p = self.problem
        return np.asarray(p.y - p.plain_fit(p.train)[1])

    def fitted(self, *more: Array, y: Array | None = None) -> tuple[Array, Array]:
        """Columns of the base and `more` (n_fitted, k), each divided by its size, and their fit.

        The fit is what they make by least squares of `y` (n_fitted,), the response unless given.
        """
        p, x = self.problem, np.hstack([self.problem.base, *more])
        size, y = np.linalg.norm(x[p.train], axis=0), p.y if y is None else y
        x = x[:, size > 0] / size[size > 0]
        return x, x @ np.linalg.lstsq(x[p.train], y[p.train], rcond=1e-8)[0]

    @property
    def weighed(self) -> bool:
        """Whether a weight over the angle, or over several joints', is a declared term."""
        return any(name.startswith("gravity_") for name in self.declared)

    @property
    def stroke(self) -> float:
        """The usual travel between two reversals, position units."""
        return float(np.quantile(np.abs(self.view.since[self.view.ok]), 0.95)) or 1.0

    @cached_property
    def one_speed(self) -> tuple[float, float]:
        """Speed, position units per s, that all files have, each its own way, and the rms off it.

        None of an axis with two motors, whose volts tell a line in time.
        """
        v, p = self.view, self.problem
        own = [(p.session == k).astype(float) for k in np.unique(p.session)]
        ways = sum(np.sign(np.sum(v.speed[v.rows] * rows * p.valid)) * rows for rows in own)
        steady = np.column_stack([v.t[v.rows] * ways, *own])
        if self.pair is not None or not p.valid.any():
            return 0.0, np.inf
        beta = solve(steady[p.valid], v.x[v.rows][p.valid])
        return float(beta[0]), float(np.std((v.x[v.rows] - steady @ beta)[p.valid]))

    def shaped(self, full: Callable[[Array], Array]) -> Callable[[Array], Array]:
        """Columns on the fitted rows as a function of nonlinear parameters."""

        def at(p: Array) -> Array:
            found = self.at(full(p))
            return found[:, None] if found.ndim == 1 else found

        return at
