"""A damaged tooth: a short pulse once per turn of one shaft, found by folding the residual over that
shaft."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from calibration.candidates.candidate import Candidate
from calibration.candidates.context import Context
from calibration.readers.run import Array

WIDTHS = (0.006, 0.0085, 0.012, 0.018, 0.027, 0.04, 0.06, 0.085)  # of a turn, full width of a raised cosine


def pulse(phase_turns: Array, centre: float, width: float, reach: Array) -> Array:
    """Raised cosine of full width `width` turns at `centre`, widened to what one analysis sample sweeps
    (`reach`)."""
    away = np.abs((phase_turns - centre + 0.5) % 1.0 - 0.5)
    wide = np.maximum(width, reach)
    return np.asarray(
        np.where(away < wide / 2, 0.5 * (1 + np.cos(2 * np.pi * away / wide)), 0.0) * width / wide
    )


def damaged_teeth(
    c: Context, e: Array, rows: NDArray[np.bool_], period_s: float, keep: int = 3
) -> list[Candidate]:
    """The best few pulses on every shaft that turns about once in the log."""
    out = []
    turns = c.angle / c.turn
    for stage in c.train.toothed:
        order = c.train.orders[stage]
        if np.ptp(turns) * order < 0.9:
            continue
        phase = turns * order
        reach = np.abs(c.speed) / c.turn * order * period_s * 2
        ok = rows & (reach < 0.12)
        if ok.sum() < 500:
            continue
        for centre, width in folded(phase[ok], e[ok], keep):
            shape = _shape(phase, reach)
            out.append(
                Candidate(
                    "damaged_tooth",
                    "axis_angle" if stage != c.train.motor else "motor_angle",
                    shape(np.array([centre, width])),
                    (("amplitude", c.unit),),
                    stage=stage,
                    harmonic=None,
                    order=order,
                    fixed={"phase": (centre, "turn"), "width": (width, "turn")},
                    shape=shape,
                    steps=(0.003, 0.1 * width),
                    least=20.0,
                )
            )
    return out


def folded(phase: Array, e: Array, keep: int) -> list[tuple[float, float]]:
    """Centre and width, turns, of the `keep` pulses that take most off the residual `e` (n,) at `phase`
    (n,)."""
    ranked = []
    bins = 240
    place = (phase % 1.0 * bins).astype(np.int64) % bins
    total, count = np.bincount(place, e, bins), np.bincount(place, minlength=bins).astype(float)
    for width in WIDTHS:
        kernel = pulse((np.arange(bins) + 0.5) / bins, 0.5, width, np.full(bins, 1.5 / bins))
        f_kernel = np.conj(np.fft.rfft(np.roll(kernel, -bins // 2)))
        hit = np.fft.irfft(np.fft.rfft(total) * f_kernel, bins)
        f_square = np.conj(np.fft.rfft(np.roll(kernel**2, -bins // 2)))
        weight = np.fft.irfft(np.fft.rfft(count) * f_square, bins)
        score = np.where(weight > 3, hit**2 / np.maximum(weight, 3), 0.0)
        k = int(np.argmax(score))
        ranked.append((float(score[k]), k / bins, width))
    return [(centre, width) for _, centre, width in sorted(ranked, reverse=True)[:keep]]


def _shape(phase: Array, reach: Array) -> Callable[[Array], Array]:
    # the torque that the residual lacks is minus the torque on the axis
    return lambda p: -pulse(phase, float(p[0]), max(float(p[1]), 0.002), reach)[:, None]
