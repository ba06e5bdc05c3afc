"""From expected electrons to numbers: shot noise, full well, blooming, binning, readout noise, converter."""

import numpy as np
import numpy.typing as npt

from host.camera.bloom import bloom
from host.camera.models import CameraModel
from host.camera.stars import Array

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
