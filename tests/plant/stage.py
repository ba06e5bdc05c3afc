"""The power stage switch by switch: its own circuit equations in steps of 50 ns, no code of the plant's.

Winding and inductance lie between supply and drain, switch and sense resistor to ground (paper 3.3), a diode
across the winding. The winding's voltage swings over one edge from the diode's to the supply's, and back.
"""

from typing import NamedTuple

from numba import njit

STEP_S = 50e-9
EDGE_S = 200e-9
"""s, ASSUMPTION: some 200 ns of an IRF250 behind its driver; a pulse that ends before is a triangle."""


class Circuit(NamedTuple):
    """voltage, drop: V. winding, switch: ohm. inductance: H. period: s."""

    voltage: float
    drop: float
    winding: float
    switch: float
    inductance: float
    period: float


@njit(error_model="numpy")
def run(
    c: Circuit, duty: float, emf: float, current: float, periods: int
) -> tuple[float, float, float, float]:
    """Return the current after `periods`, A, and of the last one mean, mean of the supply, and peak, A.

    duty: 0..1. emf: V, against the supply. current: at the start, A.
    """
    steps = round(c.period / STEP_S)
    pulse = duty * c.period
    top = min(1.0, pulse / EDGE_S)
    mean = supply = peak = 0.0
    for _ in range(periods):
        mean = supply = peak = 0.0
        for k in range(steps):
            t = (k + 0.5) * STEP_S
            share = min(t / EDGE_S, top) if t <= pulse else max(0.0, top - (t - pulse) / EDGE_S)
            driven = share * (c.voltage - c.switch * current) - (1.0 - share) * c.drop
            before = current
            current += STEP_S / c.inductance * (driven - emf - c.winding * current)
            current = max(0.0, current)
            mean += 0.5 * (before + current) / steps
            supply += 0.5 * share * (before + current) / steps
            peak = max(peak, current)
    return current, mean, supply, peak
