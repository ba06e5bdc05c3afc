"""A line of a fixed frequency that is quicker than a balance's filter: mains pick-up, a converter's beat."""

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d

from calibration.arrays import Array, by_median
from calibration.balances.filters import pieces, smooth
from calibration.balances.view import View
from calibration.inputs.run import last_digit
from calibration.statistics.orders import around, power_of_two

QUICK = 0.19  # cycles per standard deviation of the filter, which passes half of such a line: arithmetic
TOP = 0.48  # cycles per row: next to half a cycle a line and the rows' own alternation are one. ASSUMPTION
FEWEST = 2048  # rows of a file before its spectrum has quiet bins beside a line. ASSUMPTION
NEAR = 64  # bins, of whose median the noise around a line is taken. ASSUMPTION
BY_CHANCE = 1e-6  # that noise alone makes the highest of all bins as high. ASSUMPTION
# of the column's own noise from row to row: a weaker line changes nothing that is told. ASSUMPTION
MATTERS = 0.5
JUMP = 8.0  # of the usual deviation: a sine has 1.4 of its own at most (ASSUMPTION)
# factor within which its size must be the same in slow, middling and quick rows. ASSUMPTION: two, and a
# quarter more, since mains of a sealed axis log have 2.04 (development seed 1980)
ALIKE = 2.5
APART = 0.7  # of the quick third's speed, below which the slow third's is another speed. ASSUMPTION


def pick_up(view: View, top: float = TOP) -> tuple[float, float] | None:
    """Hz and amplitude, in the response's unit, of the strongest line that is there at every speed; or None.

    What turns with the drive has a frequency that follows the speed, so at one speed alone nothing is said.
    top: of a line, cycles per row.
    """
    full = view.columns.get(view.response.channel)
    if full is None or view.sigma <= 0 or view.response.divide_by or not view.ok.any():
        return None
    y = full * view.response.gain
    quick = np.where(view.ok, y - smooth(y, view.segment, view.sigma), 0.0)
    jumps = np.abs(quick) > JUMP * float(np.median(np.abs(quick[view.ok])))  # where friction turns
    calm = view.ok & (maximum_filter1d(jumps.astype(float), 2 * round(4 * view.sigma) + 1) == 0)
    spans = [(a, b) for a, b in pieces(view.file) if b - a >= FEWEST]
    if not spans:
        return None
    size = power_of_two(max(b - a for a, b in spans))
    power = np.zeros(size // 2 + 1)
    for a, b in spans:
        power += np.abs(np.fft.rfft(quick[a:b] * np.hanning(b - a), size)) ** 2 / (b - a)
    f = np.fft.rfftfreq(size)  # cycles per row
    use = (f > QUICK / view.sigma) & (f < top)
    if use.sum() < 4 * NEAR:
        return None
    ratio = np.where(use, power / np.maximum(around(power, NEAR), 1e-300), 0.0)
    at = int(np.argmax(ratio))
    # the mean of n exponential bins is above r times its expectation with less than exp(n (1 - r + ln r))
    n, r = len(spans), float(ratio[at])
    if r <= 1 or n * (r - 1 - np.log(r)) < np.log(use.sum() / BY_CHANCE):
        return None
    everything = np.ones(len(quick), dtype=bool)
    near = (at + np.linspace(-1.0, 1.0, 21)) / size  # within a bin
    line = float(max(near, key=lambda f: _sizes(quick, spans, f, everything)))
    whole = _sizes(quick, spans, line, calm)
    noise = by_median(quick[view.ok])
    step = max(view.quanta.get(view.response.channel, 0.0), last_digit(full[view.ok]))
    if whole <= 0.5 * step * abs(view.response.gain):
        return None  # rounding leaves as much
    if whole / np.sqrt(2.0) < MATTERS * noise or not _at_every_speed(view, quick, spans, line, whole):
        return None
    taken_away = 1.0 - float(view.filter.gain(line))
    return line / view.period_s, whole / taken_away


def _sizes(e: Array, spans: list[tuple[int, int]], line: float, rows: NDArray[np.bool_]) -> float:
    """Amplitude of the sine of `line` cycles per row on `rows`; every file has its own phase."""
    total, weight = 0.0, 0
    for a, b in spans:
        use = np.flatnonzero(rows[a:b])
        if len(use):
            z = np.mean(e[a:b][use] * np.exp(-2j * np.pi * line * use))
            total += len(use) * float(np.abs(2 * z)) ** 2
            weight += len(use)
    return float(np.sqrt(total / weight)) if weight else 0.0


def _at_every_speed(view: View, e: Array, spans: list[tuple[int, int]], line: float, whole: float) -> bool:
    """Whether the line is as large where the drive is slow as where it is quick."""
    speed = np.abs(view.speed)
    low, high = np.quantile(speed[view.ok], [1 / 3, 2 / 3])
    thirds = [view.ok & (speed <= low), view.ok & (speed > low) & (speed <= high), view.ok & (speed > high)]
    if min(t.sum() for t in thirds) < FEWEST / 8:
        return False
    middle = [float(np.median(speed[t])) for t in thirds]
    if middle[0] > APART * middle[2]:
        return False
    sizes = [_sizes(e, spans, line, t) for t in thirds]
    return all(whole / ALIKE < s < whole * ALIKE for s in sizes)
