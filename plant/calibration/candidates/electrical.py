"""Electrical effects (channel E), as volts over duty, current, speed and time."""

from __future__ import annotations

import numpy as np

from plant.calibration.candidates.candidate import Candidate
from plant.calibration.channels.electrical import Electrical
from plant.calibration.readers.run import Array


def electrical_effects(e: Electrical, clock: Array) -> list[Candidate]:
    """Candidates of the stacked E problem; `clock` (n,) is the session time of one motor's rows."""
    a, b = (e.motor == 0).astype(float), (e.motor == 1).astype(float)
    r = e.resistance
    one = np.ones(len(e.duty))
    t = np.concatenate([clock, clock])
    amp = (("offset", "A"),)
    out = [
        Candidate("adc_offset", "current", (-r * a)[:, None], amp, stage=None, fixed={"motor": (0, "A=0, B=1")}),
        Candidate("adc_offset", "current", (-r * b)[:, None], amp, fixed={"motor": (1, "A=0, B=1")}),
        Candidate("adc_gain", "current", (-r * e.current * a)[:, None], (("gain", "1"),), fixed={"motor": (0, "A=0, B=1")}),
        Candidate("pwm_deadband", "command", (e.supply * one)[:, None], (("u0", "1"),), sign=1),
        Candidate("diode_braking", "velocity", (-e.dragged)[:, None], (("constant_share", "V s/rad"),), sign=1),
        Candidate("supply_sag", "current", (e.duty * e.sum_power)[:, None], (("source_resistance", "ohm"),), sign=1),
    ]
    for tau in (20.0, 40.0, 70.0, 100.0, 160.0, 300.0):
        heat = _heat(e, clock, tau)
        out.append(Candidate("winding_heating", "time", (e.current * heat)[:, None], (("rise", "ohm/A2"),), sign=1,
                             fixed={"tau": (tau, "s")}))
    low, high = float(clock.min()), float(clock.max())
    for at in np.linspace(-0.3, 0.95, 16) * (high - low) + low:
        on = (t > at).astype(float)
        if 0.02 < on.mean() < 0.98:
            out.append(Candidate("magnet_weakening", "time", (e.pulling * on)[:, None], (("change", "V s/rad"),),
                                 fixed={"onset": (float(at), "s")}))
    for mask, k in ((a, 0.0), (b, 1.0)):
        out.append(Candidate("magnet_weakening", "velocity", (e.pulling * mask)[:, None], (("change", "V s/rad"),),
                             fixed={"motor": (k, "A=0, B=1")}))
    return out


def _heat(e: Electrical, clock: Array, tau: float) -> Array:
    """Low-passed i^2 of each motor, starting cold with each gap in the clock."""
    n = len(clock)
    step = np.diff(clock, prepend=clock[0])
    out = np.zeros(2 * n)
    for at in (0, n):
        state = 0.0
        square = (e.current[at:at + n] ** 2).tolist()
        values = []
        for dt, s in zip(step.tolist(), square, strict=True):
            decay = np.exp(-max(dt, 0.0) / tau)
            state = s + (state - s) * decay
            values.append(state)
        out[at:at + n] = values
    return out
