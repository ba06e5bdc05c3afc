"""The flat field: how much of the light a pixel turns into charge, against one in the middle of the field."""

import numpy as np

from bus.time import generator
from host.camera.models import CameraModel, Window
from host.camera.stars import Array

PIXEL_RESPONSE = 0.01
"""Standard deviation of the pixels' response. ASSUMPTION: front-lit detectors have 0.5 to 2 %."""


def cosines(model: CameraModel, window: Window) -> Array:
    """Cosine of the angle from the axis, in the middle of every pixel of a window; rows from the top."""
    x = (window.left + np.arange(window.width) - (model.width - 1) / 2) * model.pixel_rad
    y = (window.top + np.arange(window.height) - (model.height - 1) / 2) * model.pixel_rad
    return np.asarray(1 / np.sqrt(1 + y[:, None] ** 2 + x**2))


def flat(model: CameraModel, window: Window) -> Array:
    """Response of a window's pixels; without the cosine its mean is one.

    An aperture seen aslant is narrower, by the cosine. Nothing else is cut off up to 8.5°: there the beam of
    a corrector of 0.5 m leaves the mirror of 0.8 m. It is 1 m away (paper, section 1: 50/80 cm, f/1).
    A detector is the same in every night. Rows have generators of their own, so windows agree.
    """
    rows = np.empty((window.height, window.width))
    for k in range(window.height):
        row = generator(0, f"flat {model.name} {window.top + k}").standard_normal(model.width)
        rows[k] = 1 + PIXEL_RESPONSE * row[window.left : window.left + window.width]
    return rows * cosines(model, window)
