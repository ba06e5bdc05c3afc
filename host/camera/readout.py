"""From expected electrons to numbers: shot noise, full well, blooming, binning, readout noise, converter."""

import numpy as np
import numpy.typing as npt

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


def bloom(charge: Array, full_well_e: float) -> tuple[Array, float]:
    """Electrons of every pixel, none above the full well, and how many left the chip; rows from the top.

    Channel stops part the columns of a CCD, so charge goes up and down alone. ASSUMPTION: half of what a well
    cannot hold goes either way. It fills well after well; what reaches an end has left the chip.
    """
    full = np.flatnonzero((charge > full_well_e).any(axis=0))
    if not len(full):
        return charge, 0.0
    columns = charge[:, full]
    excess = np.maximum(columns - full_well_e, 0.0)
    columns -= excess
    lost = 0.0
    for rows in (range(len(columns)), range(len(columns) - 1, -1, -1)):
        carried = np.zeros(len(full))
        for k in rows:
            carried += excess[k] / 2
            filled = np.minimum(carried, full_well_e - columns[k])
            columns[k] += filled
            carried -= filled
        lost += float(carried.sum())
    result = charge.copy()
    result[:, full] = columns
    return result, lost


Counts = npt.NDArray[np.uint16]


def read_out(model: CameraModel, electrons: Array, binning: int, random: np.random.Generator) -> Counts:
    """ADU of every bin. Bins are summed on the chip and read once.

    Charge beyond the full well blooms, where the detector does; a drain takes it otherwise.
    """
    charge = random.poisson(electrons).astype(float)
    charge = bloom(charge, model.full_well_e)[0] if model.blooms else np.minimum(charge, model.full_well_e)
    height, width = charge.shape[0] // binning, charge.shape[1] // binning
    cut = charge[: height * binning, : width * binning]
    summed = cut.reshape(height, binning, width, binning).sum(axis=(1, 3))
    read = summed + random.normal(0.0, model.read_noise_e, summed.shape)
    counts = np.rint(read / model.gain_e_adu) + model.offset_adu
    return np.asarray(np.clip(counts, 0, model.most_adu), dtype=np.uint16)
