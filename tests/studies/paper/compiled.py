"""A bench on the compiled loop of the plant room: several hundred times real time, for the search.

The loop starts anew at every call, so the bench keeps its commands and runs all of them again, up to the
last one; that is deterministic and still fast for the two or three commands an experiment gives. Rows are
never judged on it: the search uses it and the emulator has the last word.
"""

import numpy as np

from plant.loop import Excitation, simulate
from plant.model import with_value
from plant.parts import PlantModel
from scenarios.studies.paper.measures import Array, Log
from scenarios.studies.paper.scales import ARCSEC, LOG_PERIOD_S
from scenarios.studies.paper.starts import START_STEPS

RAMP = 7200.0 * LOG_PERIOD_S
"""arcsec/s per sample: the firmware's acceleration limit, 2 deg/s2 (Table 1)."""


class CompiledBench:
    """A bench (see runs.py); gains: (Kp, Ki) instead of the plant file's."""

    def __init__(
        self,
        model: PlantModel,
        seed: int = 1,
        gains: tuple[float, float] | None = None,
        start_steps: float = START_STEPS,
    ) -> None:
        self._start_steps = start_steps
        if gains is not None:
            model = with_value(with_value(model, "controller.kp", gains[0]), "controller.ki", gains[1])
        self._model = model
        self._seed = seed
        self._setpoint = np.zeros(0)
        self._effort = np.zeros(0)
        self._rate = 0.0

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point."""
        rows = round(seconds / LOG_PERIOD_S)
        before = self._rate if not self._setpoint.size or np.isnan(self._setpoint[-1]) else self._setpoint[-1]
        ramp = before + np.sign(arcsec_s - before) * RAMP * np.arange(1, rows + 1)
        low, high = min(before, arcsec_s), max(before, arcsec_s)
        return self._run(np.clip(ramp, low, high), np.zeros(rows))

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort."""
        rows = round(seconds / LOG_PERIOD_S)
        return self._run(np.full(rows, np.nan), np.full(rows, float(effort)))

    def _run(self, setpoint: Array, effort: Array) -> Log:
        self._setpoint = np.concatenate([self._setpoint, setpoint])
        self._effort = np.concatenate([self._effort, effort])
        found = simulate(
            self._model,
            "ra",
            self._setpoint.size * LOG_PERIOD_S,
            Excitation(setpoint=self._setpoint, effort=self._effort, start_steps=self._start_steps),
            seed=self._seed,
        )
        last = slice(self._setpoint.size - setpoint.size, None)
        true_rate = found.truth["rate"] / ARCSEC
        columns = (found.t, found.velocity, found.effort, found.adc_a, found.adc_b, true_rate)
        log = Log(*(np.ascontiguousarray(column[last]) for column in columns))
        self._rate = float(log.rate[-1])
        return log
