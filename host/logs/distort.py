"""What a log effect does to the rows of a packet: samples lost or repeated, stamps jittered, columns cut.

A function is called as its effect, and takes a generator and the effect's parameters by name, SI units.
"""

from collections.abc import Sequence

import numpy as np

from host.logs.axis import Distortion, Row

WRAPPED = (("effort",), ("position",), ("velocity",), ("adc_a", "adc_b"), ("tach_a", "tach_b"))
"""Columns that `log_wrap` names by number."""
_UNSIGNED = {"position", "adc_a", "adc_b"}


def sample_loss(random: np.random.Generator, *, packet_loss: float, repeats: float) -> Distortion:
    """Lose whole packets with probability `packet_loss`; repeat the sample before with `repeats`."""

    def distort(rows: list[Row]) -> list[Row]:
        if random.random() < packet_loss:
            return []
        if repeats > 0.0:
            again = random.random(len(rows)) < repeats
            for index in range(1, len(rows)):
                if again[index]:
                    rows[index] = (rows[index][0], rows[index - 1][1])
        return rows

    return distort


def clock_jitter(random: np.random.Generator, *, deviation: float) -> Distortion:
    """Move every time stamp by a normal deviate."""

    def distort(rows: list[Row]) -> list[Row]:
        off = random.normal(0.0, deviation, len(rows))
        return [(t + float(delta), sample) for (t, sample), delta in zip(rows, off, strict=True)]

    return distort


def log_wrap(random: np.random.Generator, *, column: float, bits: float, mode: float) -> Distortion:
    """Keep only `bits` bits of a column: wrapped (mode 0), or clipped to what they hold (1)."""
    names, size = WRAPPED[int(column)], 1 << int(bits)

    def kept(name: str, value: int) -> int:
        low = 0 if name in _UNSIGNED else -size // 2
        return min(max(value, low), low + size - 1) if mode >= 0.5 else (value - low) % size + low

    def distort(rows: list[Row]) -> list[Row]:
        return [
            (t, sample._replace(**{name: kept(name, getattr(sample, name)) for name in names}))
            for t, sample in rows
        ]

    return distort


def chain(distortions: Sequence[Distortion]) -> Distortion | None:
    """One after the other; None when there is nothing to do."""
    if not distortions:
        return None

    def distort(rows: list[Row]) -> list[Row]:
        for each in distortions:
            rows = each(rows)
        return rows

    return distort


def channel_delay(random: np.random.Generator, *, column: float, delay: float) -> Distortion:
    """Show the effort late: the one in force `delay` earlier (the plant itself delays other columns)."""
    past: list[tuple[float, int]] = []

    def late(t: float, effort: int) -> int:
        past.append((t, effort))
        while len(past) > 1 and past[1][0] <= t - delay + 1e-9:
            past.pop(0)
        return past[0][1]

    def distort(rows: list[Row]) -> list[Row]:
        return [(t, sample._replace(effort=late(t, sample.effort))) for t, sample in rows]

    return distort
