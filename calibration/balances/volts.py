"""Electrical balances: a rig's one winding, or those of two motors that pull against each other.

u = R i + K v + L di/dt; R holds brushes and bridge. A rig's volts may be a duty times the supply.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from calibration.arrays import Array
from calibration.balances.floors import floor_of, passed
from calibration.balances.problem import Problem
from calibration.balances.thresholds import FEWEST_ROWS
from calibration.balances.view import View

# of the volts' rms, that meters and rounding are sure to. ASSUMPTION: dividers have 0.1 to 1 % of full scale
LEAST = 0.002
LAG = "inductance_with_lag"  # a current that is read T late adds R T to it


@dataclass(frozen=True, kw_only=True)
class Counter:
    """What two motors add, motor A's rows before motor B's.

    At full rate (2 n,): `share` of the effort that is a duty, 1 where it leads. Fitted (2 n_analysis,):
    `lagging` 1 with the counter torque, `dragged` rad/s against its pull where no diode is declared.
    """

    share: Array
    lagging: Array
    dragged: Array


@dataclass(frozen=True, kw_only=True)
class Windings:
    """Columns of one winding, or of motor A and then of motor B.

    At full rate (n,): current A; duty, and the supply V that it is of, empty where volts are measured. `at`
    takes such columns to the fitted rows. On these (n_fitted,): rate of the motor that makes back-EMF. Of two
    motors it is in rad/s the way each pulls, zero where it is dragged and no diode is declared. Also
    (n_fitted,): clock s, and the time in every file where files are several runs of a rig. resistance ohm,
    constant V per unit of the rate: fitted without any effect.
    """

    at: Callable[[Array], Array]
    current: Array
    rate: Array
    clock: Array
    duty: Array = field(default_factory=lambda: np.zeros(0))
    supply: Array = field(default_factory=lambda: np.zeros(0))
    since_run: Array | None = None
    counter: Counter | None = None
    resistance: float = 0.0
    constant: float = 0.0

    @property
    def measured(self) -> bool:
        """Whether volts are measured behind the bridge: there is no duty."""
        return not len(self.duty)

    @property
    def count(self) -> int:
        """Motors."""
        return 1 if self.counter is None else 2

    def together(self, full: Array) -> Array:
        """Sum over the motors of a full-rate column, on every motor's rows."""
        return np.asarray(np.tile(np.sum(np.split(full, self.count), axis=0), self.count))


@dataclass(frozen=True, kw_only=True)
class Volts:
    """floor: V that a rig's columns leave, and where from. constant_error: standard error, of two motors."""

    problem: Problem
    windings: Windings
    constant_error: float = 0.0
    floor: float | None = None
    floor_from: str = ""


def has_volts(view: View) -> bool:
    """Whether a log has a motor's current and its volts, or its duty."""
    return "current" in view.columns and bool({"voltage", "duty"} & set(view.columns))


def volts_balance(view: View, balance: Problem) -> Volts | None:
    """The electrical balance on the rows of another one; None where the log has no volts or no current."""
    if not has_volts(view):
        return None
    columns, i = view.columns, view.columns["current"]
    volts, duty, supply = columns.get("voltage"), np.zeros(0), np.zeros(0)
    if volts is None:
        duty, supply = columns["duty"], columns.get("supply", np.full(len(i), view.rig.supply_V or 0.0))
        volts = duty * supply
    p = replace(
        balance,
        channel="E",
        unit="V",
        y=view.at(volts),
        base=view.at(np.column_stack([i, view.rate(view.x), view.rate(i)])),
        base_labels=[("resistance", "ohm"), ("torque_constant", f"V s/{view.angle_unit}"), (LAG, "H")],
        valid=view.ok[view.rows],
        fresh=None,
        floor=0.0,
        resolved=None,
    )
    if p.train.sum() < FEWEST_ROWS:
        return None
    p.step = LEAST * float(np.std(p.y[p.train]))
    fitted, _ = p.plain_fit(p.train)
    # of both columns from row to row, behind the filter
    noises = passed(view, volts), passed(view, i * fitted["resistance"])
    p.floor = float(np.hypot(noises[0] or 0.0, noises[1] or 0.0)) if None not in noises else 0.0
    floor, source = floor_of(view, p)
    windings = Windings(
        at=view.at,
        current=i,
        rate=p.base[:, p.place("torque_constant")],
        clock=p.t - p.t.min(),
        duty=duty,
        supply=supply,
        since_run=view.t[view.rows] if len(np.unique(p.session)) > 1 else None,
        resistance=fitted["resistance"],
        constant=fitted["torque_constant"],
    )
    return Volts(problem=p, windings=windings, floor=floor, floor_from=source)
