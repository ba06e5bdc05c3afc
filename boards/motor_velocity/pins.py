"""Pins of the motor velocity board."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class MotorVelocityPins:
    """encoder: quadrature inputs, (t_ns) -> counts, 4096 a motor turn (1024 lines, ASSUMPTION)."""

    encoder: Callable[[int], int]
