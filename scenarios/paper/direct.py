"""The axis without the boards around it: the firmware's own PI on the plant's own kernels, for quick looks
and search.

No bus, no interrupts, no crystal: the controller samples every 5 ms exactly and its output acts `LATENCY_NS`
later. Rows are never judged on it; the search uses it and the emulator has the last word.
"""

import numpy as np

from boards.axis.config import AxisConfig, rate_q16
from boards.axis.pi import IncrementalPi
from boards.silicon.adc import CurrentAdc
from boards.silicon.pwm import MotorPwm
from plant.parts import PlantModel
from plant.plant import Plant
from scenarios.paper.log import Log
from scenarios.paper.scales import ARCSEC, EFFORT_SCALE

TICK_NS = 5_000_000
LATENCY_NS = 50_000
"""From the sample to the PWM register: the interrupt routine's run time. ASSUMPTION, as in the axis board's
table."""
START_STEPS = 1 << 28
"""The axis begins half a turn from the soft limits, absolute encoder steps."""


class DirectBench:
    """A bench (see bench.py) on the plant alone; gains: (Kp, Ki) instead of the plant file's."""

    def __init__(self, model: PlantModel, seed: int = 1, gains: tuple[float, float] | None = None) -> None:
        controller = model.controller
        kp, ki = gains or (controller.kp.si, controller.ki.si)
        steps = round(controller.pwm_steps.si)
        self._plant = Plant(model, seed, {"ra": float(START_STEPS)})
        self._port = self._plant.ra
        self._pi = IncrementalPi(round(kp * 4096), round(ki * 4096), steps)
        self._pwm = MotorPwm(self._port.drive, steps, round(controller.pwm_frequency.si))
        self._adc = CurrentAdc(self._port.current)
        self._split = controller.counter_split.si
        self._steps = steps
        self._acceleration = AxisConfig().acceleration
        self._tick = 0
        self._before = self._port.incremental(0)
        self._angle = self._port.truth(0)[0]
        self._velocity = 0
        self._setpoint = 0
        self._open = False
        self._effort = 0

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point."""
        wanted = rate_q16(arcsec_s)
        if self._open:
            self._setpoint = self._velocity << 16
            self._pi.start(self._effort, self._setpoint, self._velocity)
            self._open = False
        return self._run(seconds, wanted)

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort."""
        self._open = True
        self._effort = effort * self._steps // EFFORT_SCALE
        return self._run(seconds, 0)

    def _run(self, seconds: float, wanted: int) -> Log:
        rows = []
        port, pi = self._port, self._pi
        for _ in range(round(seconds / 0.005)):
            self._tick += 1
            t = self._tick * TICK_NS
            counts = port.incremental(t)
            velocity = self._velocity = counts - self._before
            self._before = counts
            if not self._open:
                step = self._acceleration
                self._setpoint += max(-step, min(step, wanted - self._setpoint))
                self._effort = pi.step(self._setpoint, velocity)
            effort = self._effort
            lag = int(abs(effort) * self._split + 0.5)
            self._pwm.write(t + LATENCY_NS, *((effort, lag) if effort >= 0 else (lag, -effort)))
            if not self._tick & 1:
                angle = port.truth(t)[0]
                true_rate = (angle - self._angle) / ARCSEC / 0.010
                self._angle = angle
                scaled = effort * EFFORT_SCALE // self._steps
                rows.append(
                    (t * 1e-9, velocity, scaled, self._adc.read(t, 0), self._adc.read(t, 1), true_rate)
                )
        return Log(*np.array(rows, dtype=np.float64).T)
