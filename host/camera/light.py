"""Light on a detector: stars along the path of the telescope, through seeing and focus."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from bus.units import ARCSEC, ARCSEC_PER_RAD
from host.camera.models import CameraModel, Look, Window
from host.camera.readout import cosines
from host.camera.seeing import Wander, sigma_arcsec
from host.camera.stars import Array, Sky, Stars, catalogued, observed, plane, turning
from host.sky.observed import Clock
from host.sky.site import Site

SKY_MAGNITUDE = 21.0
"""Of a square arcsecond. ASSUMPTION: a dark night without the Moon."""
_CELL_PX = 0.25
"""The path is gathered in cells of this size; far below an image's width."""
_STEP_PX, _MOST = 0.5, 100_000
"""Between two samples of a path, and how many it has at most: 50 000 pixels' way."""
_PIECE_PX = 500.0
"""Of a path that has its own stars; of memory, and far below a field's width."""
_FASTEST_PX_S = 100.0
"""Beyond this the sky alone is seen. Simplified: a slew's trails of all stars would take minutes to draw."""
_UNSEEN_E = 0.5
"""A star that leaves less in a pixel of its trail is left out: far below the noise of a readout."""
_KNOTS = 24
"""Times at which stars are computed exactly; linear between them."""
_SIGMAS = 5.0
"""Of an image that are drawn; beyond lies a millionth of it."""
_STEP_RAD = 1e-4
"""By which the sky's turning is found; its curvature is a ten-millionth there."""
_WIDER = 1.1
"""A field is flat to some per cent at its edge: tan 2° is 2° but for a thousandth. The rest is spare."""
_MOVED_RAD = 200 * ARCSEC
"""By which a star may have moved since J2000.0: 87 years of Arcturus, the fastest with a name."""
_FINE = 8
"""Parts of a pixel, each way, by which the edge of an image out of focus is drawn."""


_erf = np.vectorize(math.erf, otypes=[float])
"""scipy has it, but is not of the base."""


def light(
    model: CameraModel, looks: Sequence[Look], window: Window, sky: Sky, site: Site, clock: Clock,
    wander: Wander,
) -> Array:  # fmt: skip
    """Expected electrons in the pixels of a window, rows from the top. looks: from opening to closing."""
    path = _sampled(model, looks, wander)
    seconds = (looks[-1].t_ns - looks[0].t_ns) * 1e-9
    background = model.zero_point_e_s * 10 ** (-0.4 * SKY_MAGNITUDE) * model.pixel_arcsec**2 * seconds
    # a pixel beside the axis sees less of the sky: its solid angle, by the cube of the cosine
    image = background * cosines(model, window) ** 3
    disc = _disc(model, looks)
    edge = len(disc) // 2
    sigma = sigma_arcsec(model.aperture_m) / model.pixel_arcsec
    margin = _SIGMAS * sigma + edge
    canvas = np.zeros((window.height + 2 * edge, window.width + 2 * edge))
    for piece, length_px in _pieces(model, path):
        seconds = float(piece[:, 5].sum())
        if length_px > _FASTEST_PX_S * seconds:
            continue
        middle = Look(round(float(piece[len(piece) // 2, 0]) * 1e9), *piece[len(piece) // 2, 1:4])
        found = _near(model, middle, window, margin + length_px, sky, site, clock)
        electrons = model.zero_point_e_s * 10 ** (-0.4 * found.magnitude)
        seen = electrons * seconds / max(length_px, 1.0) > _UNSEEN_E
        found, electrons = found.where(seen), electrons[seen]
        x, y = _tracks(model, piece, found, site, clock)
        x, y = x - window.left, y - window.top
        inside = (x > -margin) & (x < window.width + margin) & (y > -margin) & (y < window.height + margin)
        for k in np.flatnonzero(inside.any(axis=0)):
            rows = inside[:, k]
            _draw(canvas, x[rows, k] + edge, y[rows, k] + edge, piece[rows, 5] * electrons[k], sigma)
    return image + (_convolved(canvas, disc) if edge else canvas)


def _pieces(model: CameraModel, path: Array) -> Iterator[tuple[Array, float]]:
    """Rows of the path in pieces, and how long each is, px: a slewing telescope passes many fields."""
    west, north = (each / model.pixel_rad for each in _drift(path))
    steps = np.hypot(np.diff(west, prepend=west[0]), np.diff(north, prepend=north[0]))
    number = np.floor(np.cumsum(steps) / _PIECE_PX)
    for rows in np.split(np.arange(len(path)), np.flatnonzero(np.diff(number)) + 1):
        yield path[rows], float(steps[rows].sum())


def _near(
    model: CameraModel, look: Look, window: Window, room_px: float, sky: Sky, site: Site, clock: Clock
) -> Stars:
    """Stars of a window and of so many pixels around it."""
    right = (window.left + (window.width - model.width) / 2) * model.pixel_rad
    up = ((model.height - window.height) / 2 - window.top) * model.pixel_rad
    ra, dec = catalogued(look, site, clock)
    east, north = turning(look, _STEP_RAD, site, clock) @ (right, up)
    dec += math.radians(north)
    ra += math.radians(east) / max(math.cos(dec), _STEP_RAD)
    half = math.hypot(window.width, window.height) / 2 + room_px
    return sky.near(ra, dec, min(_WIDER * half * model.pixel_rad + _MOVED_RAD, math.pi / 2))


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


def _disc(model: CameraModel, looks: Sequence[Look]) -> Array:
    """The image of a point by the cone of light: an even disc of odd width, whose sum is one."""
    away_m = float(np.mean([look.focus_m for look in looks])) if model.focusing else 0.0
    radius = abs(away_m) / model.focal_length_m * model.aperture_m / 2 / model.pixel_m
    half = math.ceil(radius - 0.5) if radius > 0.5 else 0
    at = (np.arange((2 * half + 1) * _FINE) + 0.5) / _FINE - half - 0.5
    within = np.hypot(*np.meshgrid(at, at)) <= max(radius, 1.0)
    shares = within.reshape(2 * half + 1, _FINE, 2 * half + 1, _FINE).mean(axis=(1, 3))
    return np.asarray(shares / shares.sum())


def _convolved(canvas: Array, disc: Array) -> Array:
    """Every point of the canvas as the disc; the result is smaller by the disc's width less one."""
    shape = [a + b - 1 for a, b in zip(canvas.shape, disc.shape, strict=True)]
    whole = np.fft.irfft2(np.fft.rfft2(canvas, shape) * np.fft.rfft2(disc, shape), shape)
    skip = len(disc) - 1
    return np.asarray(np.maximum(whole[skip : canvas.shape[0], skip : canvas.shape[1]], 0.0))


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
