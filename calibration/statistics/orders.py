"""Spectra over order: a residual folded into fine bins, to find the few orders worth a fit."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import uniform_filter1d

from calibration.arrays import Array

# times the spectrum's power around it. ASSUMPTION: a line is offered by it, and judged elsewhere
STANDS_OUT = 12.0
# part of the mean square: such a line needs less, as the filter spreads it over its neighbours. ASSUMPTION
LARGE = 0.05
LARGE_STANDS_OUT = 5.0  # times the power around it, likewise. ASSUMPTION
HIGHEST = 4000  # cycles within the span that are searched. ASSUMPTION
PER_ROW = 0.45  # part of a period per row: quicker is not seen. ASSUMPTION: a little below the Nyquist limit
FINE = 8  # bins per cycle of the quickest line. ASSUMPTION
FEWEST_ROWS = 20  # rows, fewest, for a spectrum. ASSUMPTION
AROUND = 12  # share of 1 / span to either side, that a line is compared with. ASSUMPTION
AVOIDED = 0.75  # share of 1 / span within which a frequency is avoided. ASSUMPTION
TRIED = 60  # bins that are tried for every line that is wanted. ASSUMPTION


def order_spectrum(e: Array, angle: Array, weight: Array, top: float, fine: int = 4) -> tuple[Array, Array]:
    """(orders, z-scores): |sum w e exp(-i 2 pi order angle)|^2 over its expectation for white e.

    `angle` in turns, `weight` (n,) the amplitude with which a line enters (sign of motion, current, 1).
    Orders run from one cycle per travel to `top`, `fine` per resolution cell.
    """
    span = float(np.ptp(angle))
    if span <= 0 or len(e) < FEWEST_ROWS:
        return np.zeros(0), np.zeros(0)
    bins = int(min(max(2.5 * top * span, 64), 2**19))
    size = power_of_two(bins * fine)
    power = _folded(weight * e, (angle - angle.min()) / span, bins, size)
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


@dataclass(frozen=True, kw_only=True)
class Wanted:
    """Frequencies from `least` up, over a place or time of length `span`, `most` of them; none of `avoid`
    (k,), ascending. `large_first`: a square's fundamental has its own flanks around it."""

    span: float
    least: float
    most: int
    avoid: Array | None = None
    large_first: bool = False


def standing_out(e: Array, z: Array, label: NDArray[np.int64], want: Wanted) -> list[float]:
    """Frequencies over z (n,) where the residual `e` (n,) stands out, summed over rows of a `label` (n,)."""
    top, step = HIGHEST / want.span, np.abs(np.diff(z))
    if (step > 0).any():
        top = min(top, PER_ROW / float(np.median(step[step > 0])))
    if top <= 2 * want.least:
        return []
    cells = int(np.ceil(want.span * top * FINE))
    size, width = power_of_two(2 * cells), want.span / cells
    power, energy = np.zeros(size // 2 + 1), float(np.sum(e**2))
    for k in np.unique(label):
        rows = label == k
        power += _folded(e[rows], (z[rows] - z.min()) / want.span, cells, size) / int(rows.sum())
    f = np.arange(len(power)) / (size * width)
    use = (f >= want.least) & (f <= top)
    if want.avoid is not None:
        reach = AVOIDED / want.span
        use &= np.searchsorted(want.avoid, f + reach) == np.searchsorted(want.avoid, f - reach, side="right")
    ratio = power / np.maximum(around(power, int(AROUND * size * width / want.span)), 1e-300)
    ratio[~use] = 0.0
    large = 2 * power > LARGE * energy  # of a sine of amplitude A: A^2 / 2 over the mean square
    found: list[float] = []
    last = ~large if want.large_first else np.zeros(len(f), dtype=bool)
    for k in np.lexsort((-ratio, last, ratio < LARGE_STANDS_OUT))[: TRIED * want.most]:
        if ratio[k] < LARGE_STANDS_OUT or len(found) >= want.most:
            break
        highest = power[k] >= max(power[k - 1], power[k + 1])  # the ends are not searched
        clear = highest and (ratio[k] >= STANDS_OUT or large[k])
        if clear and all(abs(f[k] - g) * want.span > 1.0 for g in found):
            found.append(float(f[k]))
    return found


def power_of_two(least: int) -> int:
    """The smallest one that is no less."""
    return 1 << int(np.ceil(np.log2(least)))


def _folded(e: Array, part: Array, bins: int, size: int) -> Array:
    """Power of the transform over `size` of `e` (n,), summed in `bins` of the `part` (n,) of the span."""
    place = np.clip((part * bins).astype(np.int64), 0, bins - 1)
    return np.asarray(np.abs(np.fft.rfft(np.bincount(place, e, minlength=bins), size)) ** 2)


def around(power: Array, half: int) -> Array:
    """Median power around every bin: of blocks, widened, as a running median over many bins is slow."""
    count = len(power) // half + 1
    padded = np.pad(power, (0, count * half - len(power)), mode="edge").reshape(count, half)
    level = uniform_filter1d(np.median(padded, axis=1), 3, mode="nearest")
    return np.asarray(np.repeat(level, half)[: len(power)] / np.log(2.0))
