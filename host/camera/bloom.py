"""Blooming: a well that is full spills along its column."""

import numpy as np

from host.camera.stars import Array


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
