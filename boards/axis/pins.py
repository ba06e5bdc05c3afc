"""Pins of the axis board: what `scenarios/lab/network.py` connects to the plant."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class AxisPins:
    """encoder: quadrature inputs, (t_ns) -> counts. drive: gates of the two MOSFETs, (t_ns, duty_a,
    duty_b).

    current: ADC inputs behind the sense amplifiers, (t_ns, motor 0 or 1) -> A.
    """

    encoder: Callable[[int], int]
    drive: Callable[[int, float, float], None]
    current: Callable[[int, int], float]
