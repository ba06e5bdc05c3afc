"""The focus drive: half-stepping motor, belt, ball screw, shaft encoder with index, LVDT (paper, section
3.2).

Positions are in half steps from the middle of the travel. Between commands the rotor settles exponentially;
it is evaluated when somebody looks, so the focus costs nothing on the plant's grid.
"""

from math import exp, floor
from typing import Final

from mypy_extensions import mypyc_attr

from plant.parts import FocusModel

PHASES: Final = 8  # half-step pattern of a bipolar motor
REACH: Final = PHASES // 2  # a rotor further away from the coils' field than this slips to the next pole


@mypyc_attr(allow_interpreted_subclasses=True)
class FocusPort:
    """The pins of the focus board. Times are integer nanoseconds."""

    def __init__(self, model: FocusModel, start_steps: float = 0.0):
        self._half_steps = model.half_steps.si
        self._counts = model.encoder.si / self._half_steps
        self._index_width = model.index_width.si / self._counts
        self._step_m = model.screw_lead.si / (self._half_steps * model.belt_ratio.si)
        self._limit = model.travel.si / self._step_m
        self._settling_ns = model.settling.si * 1e9
        self._lvdt = (
            model.lvdt_full_scale.si,
            model.lvdt_gain_error.si,
            model.lvdt_offset.si,
            model.lvdt_nonlinearity.si,
            model.travel.si,
        )
        self._rest = float(start_steps)  # where the rotor was at _since_ns
        self._goal = float(start_steps)  # where the field holds it
        self._since_ns = 0

    def coils(self, t_ns: int, phase: int, energised: bool, hold: bool) -> None:
        """Set the coils: half-step phase 0..7; not energised, the rotor stays, braked (`hold`) or by
        friction.

        The field pulls the rotor to the nearest position of that phase; one exactly opposite cannot move it.
        """
        at = self.position(t_ns)
        self._rest = at
        self._since_ns = t_ns
        if not energised:
            # regenerative hold and free differ in torque only; the screw does not drive back
            self._goal = at
            return
        away = (phase - at + REACH) % PHASES - REACH
        goal = at if away == -REACH else at + away
        self._goal = min(self._limit, max(-self._limit, goal))

    def position(self, t_ns: int) -> float:
        """Return the true position, half steps."""
        if self._rest == self._goal:
            return self._goal
        since = max(0, t_ns - self._since_ns)
        return self._goal + (self._rest - self._goal) * exp(-since / self._settling_ns)

    def position_m(self, t_ns: int) -> float:
        """Return the true position of the focus, m from the middle."""
        return self.position(t_ns) * self._step_m

    def encoder(self, t_ns: int) -> int:
        """Return the counts of the motor's shaft encoder, from the middle of the travel."""
        return floor(self.position(t_ns) * self._counts + 0.5)

    def index(self, t_ns: int) -> bool:
        """Return whether the index pulse is high: once per motor turn, at odd half turns from the middle."""
        turn = self.position(t_ns) / self._half_steps - 0.5
        return abs(turn - floor(turn + 0.5)) * self._half_steps <= 0.5 * self._index_width

    def lvdt(self, t_ns: int) -> float:
        """Return the rectified LVDT signal, V: half of full scale in the middle, with its errors."""
        full, gain, offset, bend, travel = self._lvdt
        x = self.position_m(t_ns) / travel
        return 0.5 * full * (1.0 + (1.0 + gain) * x + bend * (x * x * x - x)) + offset
