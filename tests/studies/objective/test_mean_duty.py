"""FIDELITY, B1: the switches get the mean of the register sequence. What that leaves out, measured."""

import numpy as np
import pytest

from boards.silicon.pwm import ONE
from plant.model import load
from plant.plant import Plant
from plant.units import ARCSEC
from tests.boards.silicon.spreader import Spreader

_PWM_NS = 50_000
_TICK_NS = 5_000_000
_STEPS = 3000


def rates(wanted_q16: list[int], *, sequence: bool) -> np.ndarray:  # type: ignore[type-arg]
    """True rate, arcsec/s every 5 ms, of the axis driven with one duty per tick."""
    plant = Plant(load("low_preload_bridge"), 1, {"ra": float(1 << 28)})
    lead, lag = Spreader(), Spreader()
    out = []
    for tick, value in enumerate(wanted_q16):
        lead.value_q16, lag.value_q16 = value, value // 10
        t_ns = tick * _TICK_NS
        if sequence:
            registers = zip(lead.registers(100), lag.registers(100), strict=True)
            for k, (a, b) in enumerate(registers):  # every period of the PWM, ten to a grid step
                plant.ra.drive(t_ns + k * _PWM_NS, a / _STEPS, b / _STEPS)
        else:
            plant.ra.drive(t_ns, value / _STEPS / ONE, value // 10 / _STEPS / ONE)
        out.append(plant.ra.truth(t_ns + _TICK_NS - 1)[1] / ARCSEC)
    return np.array(out)


@pytest.mark.parametrize("step", [220.37, 240.0005])
def test_B1_the_mean_moves_the_axis_as_the_sequence_does(step: float) -> None:
    """12 s in open loop, effort wandering slowly by half a step either way."""
    ticks = np.arange(2400)
    wanted = [round(value * ONE) for value in step + 0.5 * np.sin(ticks / 200.0)]
    mean, actual = rates(wanted, sequence=False), rates(wanted, sequence=True)
    assert np.abs(mean[1000:]).min() > 5.0  # it moves
    assert np.abs(mean - actual)[1000:].max() < 0.02  # arcsec/s; FIDELITY.md quotes this bound
