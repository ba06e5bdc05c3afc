"""One axis as the boards see it: duty cycles in, encoder counts and currents out."""

from collections.abc import Callable
from math import floor

from plant.grid import Grid
from plant.kernels import layout as at


class AxisPort:
    """The pins of one axis. Times are integer nanoseconds; reads between grid points extrapolate with the
    rate.

    Motor 0 is A, which pulls in +, motor 1 is B, which pulls in -.

    incremental: counts of the roller encoder since start, unbounded. absolute: position of the on-shaft
    absolute encoder, 29 bit. auxiliary: position of the geared one, 17 bit. tachometer_a, tachometer_b:
    counts of the motors' encoders since start, unbounded. All (t_ns) -> int. current: of a motor at the PWM's
    falling edge, A, (t_ns, motor) -> float. A stuck sensor is another callable put in the place of one.
    """

    def __init__(
        self, grid: Grid, row: int, delays_ns: dict[str, int], absolute_bits: int, auxiliary_bits: int
    ):
        self._grid = grid
        self._view = grid.view
        self._base = row * at.WIDTH
        self._current_delay_ns = delays_ns["currents"]
        out = self._base + at.OUT
        late = delays_ns["position"]
        self.incremental = self._pin(at.OUT_INCREMENTAL, delays_ns["velocity"])
        self.absolute = self._pin(at.OUT_ABSOLUTE, late, (1 << absolute_bits) - 1)
        self.auxiliary = self._pin(at.OUT_AUXILIARY, late, (1 << auxiliary_bits) - 1)
        self.tachometer_a = self._pin(at.OUT_TACH_A, delays_ns["tachometers"])
        self.tachometer_b = self._pin(at.OUT_TACH_B, delays_ns["tachometers"])
        self._current = (out + at.OUT_CURRENT_A, out + at.OUT_CURRENT_B)
        self._duty = self._base + at.DUTY
        self._mean = self._base + at.MEAN_DUTY
        self.current: Callable[[int, int], float] = self._current_now

    def drive(self, t_ns: int, duty_a: float, duty_b: float) -> None:
        """Set the duty cycles, 0..1 each, from `t_ns` on; in a grid step they count for the rest of it."""
        if not (0.0 <= duty_a <= 1.0 and 0.0 <= duty_b <= 1.0):
            raise ValueError(f"duty cycles must lie within 0..1, not {duty_a}, {duty_b}")
        grid = self._grid
        if t_ns >= grid.next_ns:
            grid.advance(t_ns)
        view = self._view
        rest = (grid.next_ns - t_ns) / grid.grid_ns
        duty, mean = self._duty, self._mean
        view[mean] += (duty_a - view[duty]) * rest
        view[mean + 1] += (duty_b - view[duty + 1]) * rest
        view[duty] = duty_a
        view[duty + 1] = duty_b

    def _pin(self, reading: int, delay_ns: int, mask: int = -1) -> Callable[[int], int]:
        """Return a counter's pin. Made once: it is read hundreds of times a second."""
        grid, view = self._grid, self._view
        place = self._base + at.OUT + reading
        slope = place + 1

        def now(t_ns: int) -> int:
            if t_ns >= grid.next_ns:
                grid.advance(t_ns)
            count: float = view[place]
            rate: float = view[slope]
            return floor(count + rate * (t_ns - grid.now_ns)) & mask

        def late(t_ns: int) -> int:
            grid.advance(t_ns)
            return floor(self._late(t_ns - delay_ns, reading)) & mask

        return late if delay_ns else now

    def _late(self, t_ns: int, reading: int) -> float:
        """Return a reading of the past from the ring of kept ones; before the start, the first one."""
        grid_ns = self._grid.grid_ns
        step = max(0, t_ns // grid_ns)
        place = self._base + at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE + reading
        return self._view[place] + self._view[place + 1] * max(0, t_ns - step * grid_ns)

    def tachometer(self, t_ns: int, motor: int) -> int:
        """Return the counts of a motor's encoder since start, unbounded."""
        return (self.tachometer_b if motor else self.tachometer_a)(t_ns)

    def _current_now(self, t_ns: int, motor: int) -> float:
        """Return a motor's current at the PWM's falling edge, A, as the sense chain sees it."""
        grid = self._grid
        if t_ns >= grid.next_ns:
            grid.advance(t_ns)
        if self._current_delay_ns:
            step = max(0, (t_ns - self._current_delay_ns) // grid.grid_ns)
            row = self._base + at.DELAYS + (step % at.DELAY_ROWS) * at.OUT_SIZE
            return float(self._view[row + at.OUT_CURRENT_A + motor])
        return self._view[self._current[motor]]

    def truth(self, t_ns: int) -> tuple[float, float]:
        """Return the true angle, rad, and rate, rad/s."""
        self._grid.advance(t_ns)
        view, place = self._view, self._base + at.OUT + at.OUT_ANGLE
        angle = view[place] + view[place + 1] * (t_ns - self._grid.now_ns)
        return angle, view[self._base + at.RATE]
