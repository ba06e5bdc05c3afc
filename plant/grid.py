"""Both axes on a fixed time grid, and the record of their truth."""

from collections.abc import Callable
from typing import Final

import numpy as np
from numpy.typing import NDArray

from plant.kernels import layout as at
from plant.kernels.advance import advance
from plant.world import AXES

TRUTH_COLUMNS: Final = at.TRUTH_COLUMNS
Sink = Callable[[str, NDArray[np.float64]], None]


class Grid:
    """A world (plant/world.py), advanced when somebody looks; deterministic, whoever looks and how often."""

    def __init__(self, world: NDArray[np.float64], grid_ns: int) -> None:
        self.world = world
        self.view = memoryview(world.reshape(-1).data).cast("B").cast("d")
        self.grid_ns = grid_ns
        self.now_ns = 0
        self.next_ns = grid_ns
        self._sink: Sink | None = None
        self._every = 0
        self._room = 0
        self._drained = [0] * len(AXES)

    def advance(self, t_ns: int) -> None:
        """Bring both axes to the last grid point up to `t_ns`; going back is no error and does nothing."""
        if t_ns < self.next_ns:
            return
        now, grid = self.now_ns, self.grid_ns
        steps = (t_ns - now) // grid
        room = self._room - steps
        if room > 0 or self._sink is None:  # recording, with room for all of it: the common case
            advance(self.world, steps)
            self._room = room
        else:
            self._advance_recording(steps)
        self.now_ns = now = now + steps * grid
        self.next_ns = now + grid

    def _advance_recording(self, steps: int) -> None:
        """Advance in parts that fit the ring of truth, draining it in chunks."""
        while steps > 0:
            part = min(steps, self._room)
            advance(self.world, part)
            steps -= part
            self._room -= part
            if self._room == 0:
                self.flush()

    def record(self, sink: Sink | None, period_ns: int = 10_000_000) -> None:
        """Hand the truth of both axes to `sink(axis, rows)` every `period_ns`, from now on; None ends it.

        rows: float64 (n, 11). Columns are TRUTH_COLUMNS: t s, angle rad, rate rad/s, currents A, motor angles
        rad, gear torques and friction N m at the axis, bristle rad. The array is the sink's own. Chunks are
        of up to 256.
        """
        if self._sink is not None:
            self.flush()
        every = period_ns // self.grid_ns
        if sink is not None and (every < 1 or every * self.grid_ns != period_ns):
            raise ValueError(
                f"plant: record: the period must be a multiple of the grid step, {self.grid_ns} ns"
            )
        self._sink = sink
        self._every = every if sink is not None else 0
        self._room = self._every * (at.TRUTH_ROWS - 1)
        self.world[:, at.RECORD_EVERY] = float(self._every)

    def flush(self) -> None:
        """Hand over what the ring of truth still holds."""
        if self._sink is None:
            return
        for row, name in enumerate(AXES):
            last = int(self.world[row, at.RECORDED])
            first = self._drained[row]
            if last > first:
                ring = self.world[row, at.TRUTH : at.TRUTH + at.TRUTH_ROWS * at.TRUTH_SIZE]
                picked = np.arange(first, last) % at.TRUTH_ROWS
                self._sink(name, ring.reshape(at.TRUTH_ROWS, at.TRUTH_SIZE)[picked])
            self._drained[row] = last
        self._room = self._every * (at.TRUTH_ROWS - 1)
