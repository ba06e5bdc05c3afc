"""The plant: both axes and the focus, behind the pins of the boards."""

from collections.abc import Callable, Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

from plant.axis import AxisPort
from plant.effects.rows import values
from plant.focus import FocusPort
from plant.gears import TURN
from plant.kernels import layout as at
from plant.kernels.advance import advance
from plant.parts import AxisModel, PlantModel
from plant.world import AXES, build, grid_ns

TRUTH_COLUMNS: Final = at.TRUTH_COLUMNS
COLUMNS: Final = (
    "effort",
    "position",
    "velocity",
    "currents",
    "tachometers",
)  # choice of channel_delay and log_wrap
Sink = Callable[[str, NDArray[np.float64]], None]


class Plant:
    """Both axes on a fixed time grid, advanced when somebody looks; deterministic, whoever looks and how
    often.

    start_steps: where things stand at time 0: `ra`, `dec` in steps of the absolute encoder, `focus` in half
    steps.
    """

    def __init__(self, model: PlantModel, seed: int, start_steps: Mapping[str, float] | None = None):
        start = dict(start_steps or {})
        for word in start:
            if word != "focus" and word not in AXES:
                raise ValueError(f"plant: start_steps: '{word}' is not known; expected ra, dec, focus")
        angles = {name: start.get(name, 0.0) * TURN / 2 ** _bits(model, name) for name in AXES}
        self.model = model
        self.world = build(model, seed, angles)
        self.view = memoryview(self.world.reshape(-1).data).cast("B").cast("d")
        self.grid_ns = grid_ns(model)
        self.now_ns = 0
        self.next_ns = self.grid_ns
        self._sink: Sink | None = None
        self._every = 0
        self._room = 0
        self._drained = [0] * len(AXES)
        ports = []
        for row, name in enumerate(AXES):
            axis: AxisModel = getattr(model.axes, name)
            delays = delays_ns(axis)
            limit = (at.DELAY_ROWS - 2) * self.grid_ns
            if max(delays.values()) > limit:
                raise ValueError(f"plant: axes.{name}: channel_delay beyond {limit * 1e-9:g} s")
            self.world[row, at.DELAY_ON] = float(any(delays.values()))
            bits = axis.encoders.absolute.si, axis.encoders.auxiliary.si
            ports.append(AxisPort(self, row, delays, int(bits[0]), int(bits[1])))
        self.ra, self.dec = ports
        self.focus = FocusPort(model.focus, start.get("focus", 0.0))
        advance(self.world, 0)  # fill the readings

    def advance(self, t_ns: int) -> None:
        """Bring both axes to the last grid point at or before `t_ns`; going back is no error and does
        nothing.
        """
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

        rows: float64 (n, 11), columns TRUTH_COLUMNS: t s, angle rad, rate rad/s, currents A, motor angles
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

    def log_effects(self, axis: str) -> list[tuple[str, dict[str, float]]]:
        """Return the effects of `axis` that the log writer has to apply, with parameters in SI units.

        clock_jitter, sample_loss, log_wrap always; channel_delay only for the column `effort` (the plant
        delays the others).
        """
        part: AxisModel = getattr(self.model.axes, axis)
        found = []
        for effect in part.effects:
            given = values(effect)
            late_effort = effect.name == "channel_delay" and given["column"] == 0.0
            if effect.enabled and (late_effort or effect.name in ("clock_jitter", "sample_loss", "log_wrap")):
                found.append((effect.name, given))
        return found


def _bits(model: PlantModel, axis: str) -> int:
    part: AxisModel = getattr(model.axes, axis)
    return int(part.encoders.absolute.si)


def delays_ns(axis: AxisModel) -> dict[str, int]:
    """Return the delay of each column of the log (COLUMNS), ns: the effects called channel_delay."""
    delays = dict.fromkeys(COLUMNS, 0)
    for effect in axis.effects:
        if effect.enabled and effect.name == "channel_delay":
            given = values(effect)
            delays[COLUMNS[int(given["column"])]] += round(given["delay"] * 1e9)
    return delays
