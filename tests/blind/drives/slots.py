"""The kernel's numbers as places in one flat array (numba freezes module integers into the code)."""

from collections.abc import Mapping
from typing import Final

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

NAMES: Final = (
    # plant, SI units of the drive (kg, N or kg m2, N m)
    "MASS", "MASS2", "STIFF", "DAMP", "GAP", "VISC", "COUL", "STIC", "VS", "SIG0",
    # controller
    "GAIN", "KP", "KI", "KD", "KV", "CASCADE", "TOP",
    # effects in the plant
    "ASYM", "POSF", "POSF_K", "POSF_P", "GRAV", "GRAV_P", "LINE", "LINE_K", "LINE_P", "DRAG", "DRAG_T",
    "WARM", "WARM_TAU", "UPSET", "UPSET_F", "UPSET_SQUARE", "UPSET_INSIDE", "STRIBECK",
    # outside the catalogue
    "PREISACH", "PREISACH_W", "BRUSH", "BRUSH_K", "SCHEDULED", "SCHEDULED_V",
)  # fmt: skip
INDEX: Final = {name: place for place, name in enumerate(NAMES)}
(
    MASS, MASS2, STIFF, DAMP, GAP, VISC, COUL, STIC, VS, SIG0,
    GAIN, KP, KI, KD, KV, CASCADE, TOP,
    ASYM, POSF, POSF_K, POSF_P, GRAV, GRAV_P, LINE, LINE_K, LINE_P, DRAG, DRAG_T,
    WARM, WARM_TAU, UPSET, UPSET_F, UPSET_SQUARE, UPSET_INSIDE, STRIBECK,
    PREISACH, PREISACH_W, BRUSH, BRUSH_K, SCHEDULED, SCHEDULED_V,
) = range(len(NAMES))  # fmt: skip

COLUMNS: Final = ("effort", "x", "v", "x2", "own", "a")
EFFORT, X, V, X2, OWN, A = range(len(COLUMNS))


def vector(values: Mapping[str, float]) -> Array:
    """The kernel's array from names; what is not given is 0."""
    out = np.zeros(len(NAMES))
    for name, value in values.items():
        if name in INDEX:
            out[INDEX[name]] = value
    return out
