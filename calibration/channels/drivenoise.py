"""What the sensors of any drive leave in its balance: each column's own noise, taken through the filter."""

from __future__ import annotations

import numpy as np

from calibration.channels.balance import response_of
from calibration.channels.noise import rough
from calibration.channels.problem import Problem
from calibration.channels.recursions import stop_element
from calibration.channels.view import View, position_noise, smooth
from calibration.inputs.record import quantum
from calibration.readers.run import Array
from calibration.statistics.whitening import Mask

# mean square of white noise through a Gaussian of s rows: 1 / (2 sqrt(pi) s); of its second difference:
# 3 / (8 sqrt(pi) s^5)
PASSED = 1.0 / (2.0 * np.sqrt(np.pi))
CURVED = 3.0 / (8.0 * np.sqrt(np.pi))
# of a step, where a sensor's zero may lie: distances of the two zeros of 0.2 to 0.8 (ASSUMPTION)
ORIGINS = (0.1, 0.3, 0.6, 0.8)


def sensors_floor(view: View, p: Problem) -> float | None:
    """rms in the response's unit: noise of its column, of the position through the inertia, and the friction
    in travel that the position does not resolve. None when the log is too short to tell."""
    r = view.response
    width = max(view.sigma, 1.0)
    place = position_noise(view.x, view.file)
    curved = place * float(np.sqrt(CURVED / width**5)) / view.period_s**2
    if not r.is_force:
        return _of_sensors(view, place, width)
    if r.channel == "acceleration":
        if "acceleration" in view.columns:
            return passed(view, view.columns["acceleration"] * r.gain, width)
        return float(abs(r.gain) * curved)
    known = _resolved_noise(view, p, curved, width)
    turning = _unresolved(view, p)
    if known is None or turning is None:
        return known
    return float(np.hypot(known, np.sqrt(np.mean(turning[p.valid] ** 2))))


def resolved_rows(view: View, p: Problem) -> tuple[Mask, float] | None:
    """Rows of a force that the position's coarse steps spoil less than the noise, and the noise's rms there;
    None where the steps spoil nothing."""
    if not view.response.is_force or view.response.channel == "acceleration":
        return None
    width = max(view.sigma, 1.0)
    curved = position_noise(view.x, view.file) * float(np.sqrt(CURVED / width**5)) / view.period_s**2
    known, turning = _resolved_noise(view, p, curved, width), _unresolved(view, p)
    if known is None or turning is None:
        return None
    return p.valid & (np.abs(turning) < known), known


def _resolved_noise(view: View, p: Problem, curved: float, width: float) -> float | None:
    """rms of the force's own column and of the position through the inertia."""
    own = passed(view, response_of(view, 0.0)[0], width)
    return None if own is None else float(np.hypot(own, abs(_declared(p).get("inertia", 0.0)) * curved))


def _of_sensors(view: View, place: float, width: float) -> float | None:
    """Two position sensors against each other."""
    second = view.columns.get(view.response.channel)
    if second is None:
        return None
    gain, ratio = abs(view.response.gain), abs(view.response.ratio or 1.0)
    noise = float(np.hypot(position_noise(second, view.file) * gain, ratio * place))
    if view.sigma <= 0:
        return noise
    return max(noise * float(np.sqrt(PASSED / width)), _rounding(view, quantum(second), gain, ratio))


def _rounding(view: View, second: float | None, gain: float, ratio: float) -> float:
    """rms of what rounding in both sensors leaves behind the filter, which does not average a step that the
    motion stays on: the log's own motion, rounded again from other origins. 0 for columns without steps."""
    first = quantum(view.x)
    if first is None or second is None:
        return 0.0
    path = smooth(view.x, view.segment, 2 * view.sigma)
    left = []
    for origin in ORIGINS:
        one, two = _rounded(path, first, origin), _rounded(path * ratio / gain, second, 1.0 - origin)
        e = view.at(gain * two - ratio * one)
        left.append(float(np.mean((e - e.mean()) ** 2)))
    return float(np.sqrt(np.mean(left)))


def _rounded(path: Array, step: float, origin: float) -> Array:
    """What rounding adds to a path when the sensor's zero is a part `origin` of a step away."""
    at = path / step + origin
    return np.asarray((np.round(at) - at) * step)


def passed(view: View, full: Array, width: float) -> float | None:
    """A column's white noise after the filter, the median over files."""
    found = [rough(full[view.file == k], 2) for k in np.unique(view.file)]
    good = [x for x in found if np.isfinite(x)]
    if not good:
        return None
    return float(np.median(good) * np.sqrt(PASSED / width)) if view.sigma > 0 else float(np.median(good))


def _declared(p: Problem) -> dict[str, float]:
    beta = np.linalg.lstsq(p.base[p.train], p.y[p.train], rcond=None)[0]
    return {n: float(b) for (n, _), b in zip(p.base_labels, beta, strict=True)}


def _unresolved(view: View, p: Problem) -> Array | None:
    """Friction turns within a step of the position's sensor, and no log tells where: (n_fitted,) of a loop of
    one step after every reversal, less what the declared terms take up of it. None where nothing turns."""
    coulomb = _declared(p).get("coulomb", 0.0)
    if coulomb <= 0 or not view.dynamic or not p.valid.any():
        return None
    width = float(np.sqrt(12.0)) * position_noise(view.x, view.file)
    fresh = np.concatenate([[True], np.diff(view.file) != 0])
    loop = stop_element(np.ascontiguousarray(view.x), fresh, float(width)) / width - np.sign(view.since)
    column = coulomb * view.at(loop)
    rows = p.train
    beta = np.linalg.lstsq(p.base[rows], column[rows], rcond=None)[0]
    return np.asarray(column - p.base @ beta)
