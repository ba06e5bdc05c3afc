"""Spectra over order: a residual folded into fine bins of angle and Fourier transformed, to find the few
orders worth a fit."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from calibration.readers.run import Array


def order_spectrum(e: Array, angle: Array, weight: Array, top: float, fine: int = 4) -> tuple[Array, Array]:
    """(orders, z-scores): |sum w e exp(-i 2 pi order angle)|^2 over its expectation for white e.

    `angle` in turns, `weight` (n,) the amplitude with which a line enters (sign of motion, current, 1).
    Orders run from
    one cycle per travel to `top`, `fine` per resolution cell.
    """
    span = float(np.ptp(angle))
    if span <= 0 or len(e) < 20:
        return np.zeros(0), np.zeros(0)
    bins = int(min(max(2.5 * top * span, 64), 2**19))
    place = np.minimum(((angle - angle.min()) / span * bins).astype(np.int64), bins - 1)
    folded = np.bincount(place, weights=weight * e, minlength=bins)
    size = 1 << int(np.ceil(np.log2(bins * fine)))
    power = np.abs(np.fft.rfft(folded, size)) ** 2
    orders = np.arange(len(power)) * bins / (span * size)
    noise = float(np.mean(e**2) * np.sum(weight**2)) or 1.0
    keep = (orders >= 1.0 / span) & (orders <= top)
    return orders[keep], power[keep] / noise


def peaks(orders: Array, power: Array, count: int, apart: float) -> NDArray[np.float64]:
    """The `count` strongest orders that are at least `apart` from each other."""
    left = power.copy()
    out: list[float] = []
    for _ in range(count):
        if not len(left) or left.max() <= 0:
            break
        k = int(np.argmax(left))
        out.append(float(orders[k]))
        left[np.abs(orders - orders[k]) < apart] = 0.0
    return np.array(out)
