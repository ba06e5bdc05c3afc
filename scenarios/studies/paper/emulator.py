"""The bench that decides: the axis board's firmware on its emulated chips, its EnDat board, the bus and the
plant.

Commands go in as CAN frames; the log is what the axis board's MOTION frames carry every 10 ms (velocity,
control effort, ADC counts), as the authors' logs did. Nothing is read from the plant except the true rate,
which no verdict uses.
"""

from math import floor

import numpy as np

from bus.can import Frame
from bus.protocol import (
    COMMAND_BASE,
    MEASUREMENT_BASE,
    REPLY_BASE,
    AxisParameter,
    Device,
    Opcode,
    pack_command,
    unpack_motion,
    unpack_reply,
)
from bus.protocol.scales import rate_q16
from plant.parts import PlantModel
from plant.plant import Plant
from scenarios.lab.network import build
from scenarios.lab.networks import NetworkConfig
from scenarios.studies.paper.log import Log
from scenarios.studies.paper.scales import ARCSEC, LOG_PERIOD_S

START_STEPS = float(1 << 28)
"""Where the axis begins, absolute encoder steps: half a turn from both soft limits."""
_BOARDS = 2
"""The RA axis board and its EnDat board: the first of the lab network's order."""
_ANSWER_NS = 20_000_000
_Q12 = 4096
AXIS = Device.AXIS_RA


class BenchError(ValueError):
    """A command that the axis board did not carry out."""


class EmulatorBench:
    """A bench (see bench.py) on the emulator; gains: (Kp, Ki) instead of the plant file's, set over the
    bus."""

    def __init__(
        self,
        model: PlantModel,
        seed: int = 1,
        gains: tuple[float, float] | None = None,
        start_steps: float = START_STEPS,
    ) -> None:
        self._plant = Plant(model, seed, {"ra": start_steps})
        self._network = build(NetworkConfig(size=_BOARDS), self._plant, seed)
        self._port = self._network.wire.attach("bench")
        self._port.accept(None)
        self._network.wire.tap(self._listen)
        self._rows: list[tuple[float, int, int, int, int, float]] = []
        self._answers: list[tuple[int, int]] = []
        self._angle, self._at_ns = self._plant.ra.truth(0)[0], 0
        self._now_ns = 0
        self._wait(0.2)  # the EnDat board has to be heard before the motors may be switched on
        if gains is not None:
            for number, gain in zip((AxisParameter.KP_Q12, AxisParameter.KI_Q12), gains, strict=True):
                self._command(Opcode.SET_PARAMETER, number, round(gain * _Q12))
        self._command(Opcode.POWER, 1)

    def closed_loop(self, arcsec_s: float, seconds: float) -> Log:
        """Run the velocity loop at a set point."""
        return self._run(seconds, Opcode.SET_RATE, rate_q16(arcsec_s))

    def open_loop(self, effort: int, seconds: float) -> Log:
        """Run with a fixed effort."""
        return self._run(seconds, Opcode.OPEN_LOOP, effort)

    def _run(self, seconds: float, opcode: Opcode, argument: int) -> Log:
        self._rows = []
        self._command(opcode, argument)
        whole = floor(seconds / LOG_PERIOD_S + 1e-6)
        self._wait((whole - len(self._rows)) * LOG_PERIOD_S)
        rows = np.array(self._rows, dtype=np.float64)
        self._wait(max(0.0, seconds - whole * LOG_PERIOD_S))
        return Log(*(np.ascontiguousarray(column) for column in rows.T))

    def _wait(self, seconds: float) -> None:
        self._now_ns += round(seconds * 1e9)
        self._network.run_until(self._now_ns)

    def _command(self, opcode: Opcode, *arguments: int) -> None:
        """Send a command and wait for its answer; raises BenchError when it is not "ok"."""
        self._answers.clear()
        frame = Frame(COMMAND_BASE + AXIS, pack_command(AXIS, opcode, *arguments))
        self._port.send(frame, self._now_ns)
        self._wait(_ANSWER_NS * 1e-9)
        for answered, result in self._answers:
            if answered == opcode:
                if result:
                    raise BenchError(
                        f"axis board: {opcode.name} {arguments} was answered with result {result}"
                    )
                return
        raise BenchError(
            f"axis board: {opcode.name} {arguments} was not answered within {_ANSWER_NS // 1_000_000} ms"
        )

    def _listen(self, t_ns: int, frame: Frame, _sender: str) -> None:
        if frame.identifier == MEASUREMENT_BASE + AXIS:
            motion = unpack_motion(frame.data)
            angle = self._plant.ra.truth(t_ns)[0]
            rate = (angle - self._angle) / ((t_ns - self._at_ns) * 1e-9) / ARCSEC
            self._angle, self._at_ns = angle, t_ns
            self._rows.append((t_ns * 1e-9, motion.velocity, motion.effort, motion.adc_a, motion.adc_b, rate))
        elif frame.identifier == REPLY_BASE + AXIS:
            reply = unpack_reply(frame.data)
            self._answers.append((reply.opcode, reply.result))
