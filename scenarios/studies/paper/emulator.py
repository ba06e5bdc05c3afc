"""The bench that decides: the axis board's firmware on its emulated chips, its EnDat board, the bus and the
plant.

Commands go in as CAN frames. The log is what the axis board's MOTION frames carry every 10 ms (velocity,
control effort, ADC counts), as the authors' logs did. Nothing is read from the plant except the true rate,
which no verdict uses.
"""

from math import floor

import numpy as np

from bus.can import Frame
from bus.protocol import MEASUREMENT_BASE, AxisParameter, Opcode, unpack_motion
from bus.protocol.scales import rate_q16
from plant.parts import PlantModel
from scenarios.lab.axisbench import AXIS, AxisBench
from scenarios.studies.paper.measures import Log
from scenarios.studies.paper.scales import ARCSEC, LOG_PERIOD_S

START_STEPS = float(1 << 28)
"""Where the axis begins, absolute encoder steps: half a turn from both soft limits."""
_Q12 = 4096


class EmulatorBench(AxisBench):
    """A bench (see runs.py) on the emulator; gains: (Kp, Ki) instead of the plant file's, over the bus."""

    def __init__(
        self,
        model: PlantModel,
        seed: int = 1,
        gains: tuple[float, float] | None = None,
        start_steps: float = START_STEPS,
    ) -> None:
        super().__init__(model, seed, start_steps)
        self._rows: list[tuple[float, int, int, int, int, float]] = []
        self._angle, self._at_ns = self.plant.ra.truth(self._now_ns)[0], self._now_ns
        self.network.wire.tap(self._listen)
        if gains is not None:
            for number, gain in zip((AxisParameter.KP_Q12, AxisParameter.KI_Q12), gains, strict=True):
                self.command(Opcode.SET_PARAMETER, number, round(gain * _Q12))
        self.command(Opcode.POWER, 1)

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point."""
        return self._run(seconds, Opcode.SET_RATE, rate_q16(arcsec_s))

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort."""
        return self._run(seconds, Opcode.OPEN_LOOP, effort)

    def _run(self, seconds: float, opcode: Opcode, argument: int) -> Log:
        self._rows = []
        self.command(opcode, argument)
        whole = floor(seconds / LOG_PERIOD_S + 1e-6)
        self.wait((whole - len(self._rows)) * LOG_PERIOD_S)
        rows = np.array(self._rows, dtype=np.float64)
        self.wait(max(0.0, seconds - whole * LOG_PERIOD_S))
        return Log(*(np.ascontiguousarray(column) for column in rows.T))

    def _listen(self, t_ns: int, frame: Frame, _sender: str) -> None:
        if frame.identifier == MEASUREMENT_BASE + AXIS:
            motion = unpack_motion(frame.data)
            angle = self.plant.ra.truth(t_ns)[0]
            rate = (angle - self._angle) / ((t_ns - self._at_ns) * 1e-9) / ARCSEC
            self._angle, self._at_ns = angle, t_ns
            self._rows.append((t_ns * 1e-9, motion.velocity, motion.effort, motion.adc_a, motion.adc_b, rate))
