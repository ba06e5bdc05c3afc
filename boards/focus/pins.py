"""Pins of the focus board."""

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True, kw_only=True)
class FocusPins:
    """coils: the H-bridges, (t_ns, phase 0..7, energised, hold).

    encoder: quadrature inputs, (t_ns) -> counts.
    index: the encoder's index input, (t_ns) -> bool. lvdt: ADC input, (t_ns) -> V.
    """

    coils: Callable[[int, int, bool, bool], None]
    encoder: Callable[[int], int]
    index: Callable[[int], bool]
    lvdt: Callable[[int], float]
