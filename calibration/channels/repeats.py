"""Does the motion repeat itself, and after what time?"""

from __future__ import annotations

import numpy as np

from calibration.channels.view import View

ALIKE = 0.93  # of the autocorrelation of the position, at the lag of a repetition
ROWS = 20_000  # that are correlated


def repeat_lag(view: View) -> int:
    """Full-rate rows after which the longest file's motion repeats itself; 0 when it does not."""
    files, count = np.unique(view.file, return_counts=True)
    wanted = view.columns.get("reference", view.x)  # repeats itself better than what is done
    x = wanted[view.file == files[int(np.argmax(count))]]
    step = max(len(x) // ROWS, 1)
    x = x[::step] - x.mean()
    n = len(x)
    if n < 100 or not np.any(x):
        return 0
    size = 1 << (2 * n - 1).bit_length()
    r = np.fft.irfft(np.abs(np.fft.rfft(x, size)) ** 2, size)[:n]
    power = np.concatenate([[0.0], np.cumsum(x**2)])
    lags = np.arange(n)
    both = np.sqrt(np.maximum((power[n - lags]) * (power[n] - power[lags]), 1e-300))
    r = r / both
    far = np.flatnonzero(r[: int(0.66 * n)] < 0.3)
    if len(far) == 0:
        return 0
    first = int(far[0])
    at = first + int(np.argmax(r[first : int(0.66 * n)]))
    best = float(r[at])
    early = [k for k in range(first + 1, at) if r[k] > best - 0.01 and r[k] >= r[k - 1] and r[k] >= r[k + 1]]
    at = early[0] if early else at
    return at * step if best > ALIKE else 0


def repeat_frequency(view: View) -> float:
    """1 / time after which the motion repeats itself, Hz; 0 when it does not."""
    lag = repeat_lag(view)
    return 1.0 / (lag * view.period_s) if lag else 0.0
