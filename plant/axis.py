"""One axis as the boards see it: duty cycles in, encoder counts and currents out."""

from math import floor
from typing import TYPE_CHECKING

from plant.kernels import layout as at

if TYPE_CHECKING:
    from plant.plant import Plant


class AxisPort:
    """The pins of one axis. Times are integer nanoseconds; reads between grid points extrapolate with the
    rate.

    Motor 0 is A, which pulls in +, motor 1 is B, which pulls in -.
    """

    def __init__(
        self, plant: "Plant", row: int, delays_ns: dict[str, int], absolute_bits: int, auxiliary_bits: int
    ):
        self._plant = plant
        self._view = plant.view
        self._base = row * at.WIDTH
        self._delays = delays_ns
        self._absolute_mask = (1 << absolute_bits) - 1
        self._auxiliary_mask = (1 << auxiliary_bits) - 1
        out = self._base + at.OUT
        self._incremental = out + at.OUT_INCREMENTAL
        self._absolute = out + at.OUT_ABSOLUTE
        self._auxiliary = out + at.OUT_AUXILIARY
        self._tach = (out + at.OUT_TACH_A, out + at.OUT_TACH_B)
        self._current = (out + at.OUT_CURRENT_A, out + at.OUT_CURRENT_B)
        self._duty = self._base + at.DUTY
        self._mean = self._base + at.MEAN_DUTY

    def drive(self, t_ns: int, duty_a: float, duty_b: float) -> None:
        """Set the duty cycles, 0..1 each, from `t_ns` on; within a grid step they count for the rest of
        it.
        """
        if not (0.0 <= duty_a <= 1.0 and 0.0 <= duty_b <= 1.0):
            raise ValueError(f"duty cycles must lie within 0..1, not {duty_a}, {duty_b}")
        plant = self._plant
        if t_ns >= plant.next_ns:
            plant.advance(t_ns)
        view = self._view
        rest = (plant.next_ns - t_ns) / plant.grid_ns
        duty, mean = self._duty, self._mean
        view[mean] += (duty_a - view[duty]) * rest
        view[mean + 1] += (duty_b - view[duty + 1]) * rest
        view[duty] = duty_a
        view[duty + 1] = duty_b

    def _value(self, t_ns: int, place: int, delay_ns: int) -> float:
        """Return a reading at `t_ns`, or a delayed one."""
        plant = self._plant
        if t_ns >= plant.next_ns:
            plant.advance(t_ns)
        view = self._view
        if delay_ns:
            return self._late(t_ns - delay_ns, place)
        return view[place] + view[place + 1] * (t_ns - plant.now_ns)

    def _late(self, t_ns: int, place: int) -> float:
        """Return a reading of the past from the ring of kept ones; before the start, the first one."""
        grid = self._plant.grid_ns
        step = max(0, t_ns // grid)
        row = self._base + at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE
        place += row - self._base - at.OUT
        return self._view[place] + self._view[place + 1] * max(0, t_ns - step * grid)

    def incremental(self, t_ns: int) -> int:
        """Return the counts of the roller encoder since start, unbounded."""
        return floor(self._value(t_ns, self._incremental, self._delays["velocity"]))

    def absolute(self, t_ns: int) -> int:
        """Return the position of the on-shaft absolute encoder, 29 bit."""
        return floor(self._value(t_ns, self._absolute, self._delays["position"])) & self._absolute_mask

    def auxiliary(self, t_ns: int) -> int:
        """Return the position of the geared auxiliary encoder, 17 bit."""
        return floor(self._value(t_ns, self._auxiliary, self._delays["position"])) & self._auxiliary_mask

    def tachometer(self, t_ns: int, motor: int) -> int:
        """Return the counts of a motor's encoder since start, unbounded."""
        return floor(self._value(t_ns, self._tach[motor], self._delays["tachometers"]))

    def current(self, t_ns: int, motor: int) -> float:
        """Return a motor's current at the PWM's falling edge, A, as the sense chain sees it."""
        plant = self._plant
        if t_ns >= plant.next_ns:
            plant.advance(t_ns)
        delay = self._delays["currents"]
        if delay:
            step = max(0, (t_ns - delay) // plant.grid_ns)
            row = self._base + at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE
            return float(self._view[row + at.OUT_CURRENT_A + motor])
        return self._view[self._current[motor]]

    def truth(self, t_ns: int) -> tuple[float, float]:
        """Return the true angle, rad, and rate, rad/s."""
        angle = self._value(t_ns, self._base + at.OUT + at.OUT_ANGLE, 0)
        return angle, self._view[self._base + at.RATE]
