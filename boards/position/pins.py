"""Pins of the position board."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class PositionPins:
    """encoder: what the RCN 829 at the other end of the cable measures, (t_ns) -> steps, 29 bit."""

    encoder: Callable[[int], int]
