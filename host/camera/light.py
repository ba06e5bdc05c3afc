"""Light on a detector: stars along the path of the telescope, through seeing and focus."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bus.units import ARCSEC_PER_RAD
from host.camera.look import Look
from host.camera.models import CameraModel
from host.camera.place import catalogued, observed, plane
from host.camera.seeing import Wander, sigma_arcsec
from host.camera.stars import Array, Sky, Stars
from host.sky.observed import Clock
from host.sky.site import Site

SKY_MAGNITUDE = 21.0
"""Of a square arcsecond. ASSUMPTION: a dark night without the Moon."""
_CELL_PX = 0.25
"""The path is gathered in cells of this size; far below an image's width."""
_STEP_PX, _MOST = 0.5, 4000
"""Between two samples of a path, and how many it has at most."""
_KNOTS = 24
"""Times at which stars are computed exactly; linear between them."""
_SIGMAS = 5.0
"""Of an image that are drawn; beyond lies a millionth of it."""
_RINGS = 0.5
"""Spacing of the pupil's rays on the detector, px, when it is out of focus."""
_MOST_RAYS = 600
"""For a whole path; a long trail smears what fewer rays leave between them. ASSUMPTION."""


_ERF = (0.254829592, -0.284496736, 1.421413741, -1.453152027, 1.061405429)
"""Abramowitz and Stegun, 7.1.26: the error function to 1.5e-7."""


@dataclass(frozen=True, kw_only=True)
class Window:
    """A part of a detector, in its pixels; 0, 0 is at the upper left."""

    left: int
    top: int
    width: int
    height: int


def light(
    model: CameraModel,
    looks: Sequence[Look],
    window: Window,
    sky: Sky,
    site: Site,
    clock: Clock,
    wander: Wander,
) -> Array:
    """Expected electrons in the pixels of a window, rows from the top. looks: from opening to closing."""
    path = _sampled(model, looks, wander)
    seconds = (looks[-1].t_ns - looks[0].t_ns) * 1e-9
    background = model.zero_point_e_s * 10 ** (-0.4 * SKY_MAGNITUDE) * model.pixel_arcsec**2 * seconds
    image = np.full((window.height, window.width), background)
    middle = looks[len(looks) // 2]
    reach = math.hypot(model.width, model.height) / 2 * model.pixel_rad + _length(looks)
    found = sky.near(*catalogued(middle, site, clock), min(reach, math.pi / 2))
    if not len(found.magnitude):
        return image
    x, y = _tracks(model, path, found, site, clock)
    x, y = x - window.left, y - window.top
    rays = _rays(model, looks, len(path))
    weights = np.multiply.outer(path[:, 5], np.full(len(rays), 1 / len(rays))).ravel()
    electrons = model.zero_point_e_s * 10 ** (-0.4 * found.magnitude)
    sigma = sigma_arcsec(model.aperture_m) / model.pixel_arcsec
    margin = _SIGMAS * sigma + np.abs(rays).max()
    inside = (x > -margin) & (x < window.width + margin) & (y > -margin) & (y < window.height + margin)
    for k in np.flatnonzero(inside.any(axis=0)):
        here = np.add.outer(x[:, k], rays[:, 0]).ravel(), np.add.outer(y[:, k], rays[:, 1]).ravel()
        _draw(image, here[0], here[1], weights * electrons[k], sigma)
    return image


def _sampled(model: CameraModel, looks: Sequence[Look], wander: Wander) -> Array:
    """Rows of the path: time, hour angle, declination, roll, focus, seconds; wander is in the angles."""
    rows = np.array(looks, dtype=float)
    rows[:, 0] *= 1e-9
    steps = np.hypot(np.diff(_drift(rows)[0]), np.diff(_drift(rows)[1])) / model.pixel_rad / _STEP_PX
    count = int(np.clip(math.ceil(steps.sum()), len(rows), _MOST))
    times = rows[0, 0] + (np.arange(count) + 0.5) / count * (rows[-1, 0] - rows[0, 0])
    fine = np.stack([times, *(np.interp(times, rows[:, 0], column) for column in rows.T[1:])], axis=1)
    right, up = wander(times) / ARCSEC_PER_RAD
    fine[:, 1] -= right / np.cos(fine[:, 2])
    fine[:, 2] -= up
    cells = np.floor(np.stack(_drift(fine)) / model.pixel_rad / _CELL_PX).astype(int)
    _, cell = np.unique(cells, axis=1, return_inverse=True)
    cell = cell.ravel()
    share = np.bincount(cell).astype(float)
    means = np.stack([np.bincount(cell, column) / share for column in fine.T], axis=1)
    seconds = share / count * (rows[-1, 0] - rows[0, 0])
    return np.column_stack([means, seconds])[np.argsort(means[:, 0])]


_TURN_RAD_S = 7.2921159e-5
"""The Earth's (IERS Conventions 2010)."""


def _drift(rows: Array) -> tuple[Array, Array]:
    """How far the telescope has gone against the stars: west and north, rad."""
    west = (rows[:, 1] - rows[0, 1] - _TURN_RAD_S * (rows[:, 0] - rows[0, 0])) * np.cos(rows[:, 2])
    return west, rows[:, 2] - rows[0, 2]


def _length(looks: Sequence[Look]) -> float:
    rows = np.array(looks, dtype=float)
    rows[:, 0] *= 1e-9
    west, north = _drift(rows)
    return float(np.hypot(west, north).max())


def _tracks(model: CameraModel, path: Array, found: Stars, site: Site, clock: Clock) -> tuple[Array, Array]:
    """Pixels of every star (columns) at every row of the path."""
    times = path[:, 0]
    knots = times if len(times) <= _KNOTS else np.linspace(times[0], times[-1], _KNOTS)
    places = [observed(found, site, clock, float(t_s)) for t_s in knots]
    hour_angles = np.unwrap(np.array([place[0] for place in places]), axis=0)
    declinations = np.array([place[1] for place in places])
    xs, ys = [], []
    for row in path:
        k = min(int(np.searchsorted(knots, row[0], "right")), len(knots) - 1)
        part = 0.0 if k == 0 else (row[0] - knots[k - 1]) / (knots[k] - knots[k - 1])
        last = max(k - 1, 0)
        h, d = (each[last] + part * (each[k] - each[last]) for each in (hour_angles, declinations))
        right, up = plane(h, d, Look(0, row[1], row[2], row[3]))
        xs.append((model.width - 1) / 2 + right / model.pixel_rad)
        ys.append((model.height - 1) / 2 - up / model.pixel_rad)
    return np.array(xs), np.array(ys)


def _rays(model: CameraModel, looks: Sequence[Look], points: int) -> Array:
    """Where rays of an even pupil meet the detector, px from the middle; one ray when it is in focus.

    points: of the path, each of which has all rays.
    """
    away_m = float(np.mean([look.focus_m for look in looks])) if model.focusing else 0.0
    radius = abs(away_m) / model.focal_length_m * model.aperture_m / 2 / model.pixel_m
    if radius < _RINGS / 2:
        return np.zeros((1, 2))
    count = min(4 * math.ceil((radius / _RINGS) ** 2), max(_MOST_RAYS // points, 12))
    k = np.arange(count) + 0.5  # a sunflower fills a disc evenly
    angle = k * math.pi * (3 - math.sqrt(5))
    return np.stack([np.cos(angle), np.sin(angle)], axis=1) * (radius * np.sqrt(k / count))[:, None]


def _draw(image: Array, x: Array, y: Array, electrons: Array, sigma: float) -> None:
    """Add Gaussians, integrated over each pixel."""
    kept = np.isfinite(x) & np.isfinite(y)
    x, y, electrons = x[kept], y[kept], electrons[kept]
    if not len(x):
        return
    half = _SIGMAS * sigma + 1
    left, right = max(math.floor(x.min() - half), 0), min(math.ceil(x.max() + half), image.shape[1] - 1)
    top, low = max(math.floor(y.min() - half), 0), min(math.ceil(y.max() + half), image.shape[0] - 1)
    if left > right or top > low:
        return
    across, down = _share(x, left, right, sigma), _share(y, top, low, sigma)
    image[top : low + 1, left : right + 1] += (down * electrons[:, None]).T @ across


def _share(at: Array, first: int, last: int, sigma: float) -> Array:
    edges = np.subtract.outer(-at, -(np.arange(first, last + 2) - 0.5)) / (math.sqrt(2) * sigma)
    return np.asarray(np.diff(_erf(edges), axis=1) / 2)


def _erf(x: Array) -> Array:
    t = 1 / (1 + 0.3275911 * np.abs(x))
    return np.asarray(np.sign(x) * (1 - np.polyval((*_ERF[::-1], 0.0), t) * np.exp(-(x**2))))
