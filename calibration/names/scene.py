"""What a name sees of a log: the columns at full rate, the balance, and its declared part."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from calibration.channels.problem import Problem
from calibration.channels.view import View
from calibration.readers.run import Array
from plant.effects.evaluate import evaluate, signals

BOTH = 0.05  # of the rows in either direction: fewer say nothing of a difference between the two


@dataclass
class Scene:
    """`declared` are the fitted coefficients of the balance's base by name; `residual` (n_fitted,) what a
    flexible fit leaves, for the search of lines; `wander` the columns of that flexible fit."""

    view: View
    problem: Problem
    declared: dict[str, float]
    residual: Array
    wander: Array
    peaks: dict[str, list[float]] = field(default_factory=dict)
    model: Array | None = None  # (n_fitted,) the response with all that is named, once that is known

    @property
    def unit(self) -> str:
        """Of the balance."""
        return self.view.unit

    @property
    def angle_unit(self) -> str:
        """Of the position."""
        return self.view.angle_unit

    @property
    def force(self) -> bool:
        """True for a balance of forces."""
        return self.view.response.is_force

    def at(self, full: Array) -> Array:
        """Full-rate column(s) on the fitted rows."""
        return self.view.at(full)

    @property
    def zeros(self) -> list[tuple[NDArray[np.int64], bool]]:
        """Labels (n_fitted,) of rows that share the position's zero, and whether every label has a zero of
        its own. Files that are not declared to share it may do so, or not: both are tried."""
        own = self.problem.session
        shared = [(np.zeros_like(own), False)]
        if self.view.rig.runs.get("origin") == "shared" or len(np.unique(own)) < 2:
            return shared
        return [*shared, (own, True)]

    @property
    def volts(self) -> bool:
        """True for an electrical balance."""
        return self.view.response.channel == "voltage"

    @property
    def both(self) -> bool:
        """True when the drive goes both ways."""
        d = self.view.direction[self.view.ok]
        return bool(min(np.mean(d > 0.5), np.mean(d < -0.5)) > BOTH) if len(d) else False

    @property
    def span(self) -> float:
        """Travel, position units."""
        x = self.view.x[self.view.ok]
        return float(np.ptp(x)) if len(x) else 0.0

    @property
    def friction(self) -> Array:
        """Size of the declared friction at full rate, for what scales all of it; without a sign."""
        c, v = max(self.declared.get("coulomb", 0.0), 0.0), max(self.declared.get("viscous", 0.0), 0.0)
        if c == 0 and v == 0:
            return np.ones(len(self.view.t))
        return c + v * np.abs(self.view.speed)

    def formula(
        self, name: str, columns: dict[int, Array], parameters: dict[str, float], term: int = 0
    ) -> Array:
        """The effect's own formula (plant/effects) over full-rate columns."""
        rows = signals(len(self.view.t), columns)
        return np.asarray(evaluate(name, rows, parameters, term=term))

    def shaped(self, full: Callable[[Array], Array]) -> Callable[[Array], Array]:
        """Columns on the fitted rows as a function of nonlinear parameters."""

        def at(p: Array) -> Array:
            found = self.at(full(p))
            return found[:, None] if found.ndim == 1 else found

        return at
