"""One run: RA axis board and its EnDat board on their bus, driven by commands; true rate and angle back."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from bus.protocol import Opcode
from bus.protocol.scales import STEPS_PER_TURN, rate_q16
from plant.parts import PlantModel
from plant.units import ARCSEC
from scenarios.lab.axisbench import AxisBench

Floats = NDArray[np.float64]
SIDEREAL = 15.041  # arcsec/s, the and the paper's tracking rate.
SETTLE_S = 30.0
"""After the command. The bristles need some 17 arcsec to load (hardware.md 2.4: discard the start-up)."""
_OPCODES = {"TRACK": Opcode.TRACK_RATE, "RATE": Opcode.SET_RATE}
MODES = tuple(_OPCODES)


class Held(NamedTuple):
    """True rate less the asked one, arcsec/s; true angle less a line of that rate, arcsec; every 10 ms."""

    t_s: Floats
    rate: Floats
    angle: Floats
    lost: int
    """Interrupts the boards lost."""

    @property
    def peak(self) -> float:
        """Largest rate error, arcsec/s."""
        return float(np.abs(self.rate).max())

    @property
    def rms(self) -> float:
        """arcsec/s."""
        return float(np.sqrt(np.mean(self.rate**2)))

    @property
    def wander(self) -> float:
        """Largest angle from the best straight line of the asked rate, arcsec."""
        return float(np.ptp(self.angle) / 2)


def hold(
    model: PlantModel,
    start_deg: float,
    seed: int,
    mode: str,
    parameters: Sequence[tuple[int, int]],
    seconds: float = 600.0,
) -> Held:
    """Track or hold the sidereal rate from an angle of the absolute encoder.

    parameters: of the axis board, in the order given. The first SETTLE_S are left out.
    """
    bench = AxisBench(model, seed, float(round(start_deg / 360.0 * STEPS_PER_TURN)))
    for number, value in parameters:
        bench.command(Opcode.SET_PARAMETER, number, value)
    bench.command(Opcode.POWER, 1)
    bench.command(_OPCODES[mode], rate_q16(SIDEREAL))
    bench.wait(SETTLE_S)
    rows: list[Floats] = []
    bench.plant.record(lambda axis, chunk: rows.append(chunk) if axis == "ra" else None)
    bench.wait(seconds)
    bench.plant.flush()
    bench.plant.record(None)
    truth = np.concatenate(rows)
    t_s = truth[:, 0]
    line = truth[:, 1] / ARCSEC - SIDEREAL * t_s
    lost = sum(bench.network.overruns.values())
    return Held(t_s, truth[:, 2] / ARCSEC - SIDEREAL, line - line.mean(), lost)
