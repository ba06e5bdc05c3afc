"""From the angles of the axes to the sky: the mount's errors as rotations of vectors, exact at any size.

Frame: x to hour angle 0 on the equator, y to hour angle +6 h (west), z to the pole.
"""

from math import cos, radians, sin

import numpy as np
from numpy.typing import ArrayLike, NDArray

from plant.parts import MountErrors

Array = NDArray[np.float64]
_LOWEST = sin(radians(5.0))
"""Sine of the altitude below which tan z stays as it is; it has no bound at the horizon. ASSUMPTION."""


def sky(
    hour_angle: ArrayLike, declination: ArrayLike, latitude: float, errors: MountErrors
) -> tuple[Array, Array]:
    """Return the hour angle (-pi..pi) and declination that a telescope looks at, rad.

    hour_angle, declination: of the axes, rad, both of one shape, which the results have. latitude: rad.
    """
    h = np.asarray(hour_angle, dtype=float) - errors.hour_angle_index.si
    h = h - errors.hour_angle_eccentricity.si * np.sin(h)
    # The fork's arms give way towards the ground, about the declination axis.
    d = np.asarray(declination, dtype=float) - errors.declination_index.si
    d = d - errors.declination_eccentricity.si * np.sin(d)
    d = d - errors.fork_flexure.si * np.cos(h)
    cone, tilt = errors.collimation.si, errors.non_perpendicularity.si
    sight = np.stack([cos(cone) * np.cos(d), np.full_like(d, -sin(cone)), cos(cone) * np.sin(d)])
    axis = np.stack([np.zeros_like(d), np.full_like(d, cos(tilt)), np.full_like(d, sin(tilt))])
    sight = _turn(sight, np.array([tilt, 0.0, 0.0]))
    turn = np.stack([np.zeros_like(h), np.zeros_like(h), h])
    pole = np.array([-errors.polar_azimuth.si, errors.polar_altitude.si, 0.0])
    sight, axis = (_turn(_turn(each, turn), pole) for each in (sight, axis))
    up = _like(np.array([cos(latitude), 0.0, sin(latitude)]), sight)
    # Weight turns the declination axis, then the tube, towards the ground; air lifts what is seen.
    sight = _turn(sight, -errors.axis_flexure.si * _cross(axis, up))
    sight = _turn(sight, errors.tube_flexure.si * _cross(sight, up))
    height = np.maximum(np.sum(sight * up, axis=0), _LOWEST)
    x, y, z = _turn(sight, errors.refraction.si / height * _cross(sight, up))
    return np.arctan2(y, x), np.arctan2(z, np.hypot(x, y))


def _like(vector: Array, vectors: Array) -> Array:
    return np.broadcast_to(vector.reshape(3, *[1] * (vectors.ndim - 1)), vectors.shape)


def _cross(a: Array, b: Array) -> Array:
    return np.cross(a, b, axis=0)


def _turn(vectors: Array, rotation: Array) -> Array:
    """Turn vectors (3, ...) about `rotation`'s direction by its length, rad (Rodrigues)."""
    rotation = _like(rotation, vectors) if rotation.ndim == 1 else rotation
    angle = np.sqrt(np.sum(rotation**2, axis=0))
    about = rotation / np.where(angle > 0.0, angle, 1.0)
    along = np.sum(about * vectors, axis=0) * about
    turned: Array = along + np.cos(angle) * (vectors - along) + np.sin(angle) * _cross(about, vectors)
    return turned
