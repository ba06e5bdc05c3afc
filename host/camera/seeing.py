"""Seeing: a star's image is wide, and wanders with the spectrum of a Kolmogorov atmosphere."""

import math

import numpy as np
import numpy.typing as npt

from bus.time import generator
from bus.units import ARCSEC_PER_RAD

FWHM_ARCSEC = 2.0
"""Of a long exposure at the zenith. ASSUMPTION: a common night."""
WIND_M_S = 10.0
"""That carries the turbulence across the aperture. ASSUMPTION."""
_WAVELENGTH_M = 0.55e-6
_FWHM_PER_SIGMA = 2.3548
_LINES, _LOWEST_HZ, _HIGHEST_HZ = 120, 0.005, 50.0
"""Sinusoids in a logarithmic row; beyond its ends lies little of the power. ASSUMPTION."""


def wander_arcsec(aperture_m: float) -> float:
    """Standard deviation of an image's place in one coordinate: 0.182 (λ/D)² (D/r0)^(5/3) is its variance
    (Tatarski; Martin 1987, PASP 99, 1360)."""
    fried_m = 0.98 * _WAVELENGTH_M / (FWHM_ARCSEC / ARCSEC_PER_RAD)
    limit = _WAVELENGTH_M / aperture_m * ARCSEC_PER_RAD
    return math.sqrt(0.182) * limit * math.pow(aperture_m / fried_m, 5 / 6)


def sigma_arcsec(aperture_m: float) -> float:
    """Of the Gaussian that an image has about its wandering place, so that a long exposure has the FWHM."""
    variance = (FWHM_ARCSEC / _FWHM_PER_SIGMA) ** 2 - wander_arcsec(aperture_m) ** 2
    return math.sqrt(max(variance, 0.1))


class Wander:
    """A path through time. Its spectrum falls as f^(-2/3) and, above the knee, as f^(-11/3).

    Source: Tyler 1994, JOSA A 11, 358; the knee at 0.6 of wind over aperture: Conan et al. 1995, JOSA A 12,
    1559.
    """

    def __init__(self, aperture_m: float, seed: int, name: str) -> None:
        random = generator(seed, f"seeing {name}")
        self._hz = np.geomspace(_LOWEST_HZ, _HIGHEST_HZ, _LINES)
        knee = 0.6 * WIND_M_S / aperture_m
        power = np.where(self._hz < knee, self._hz ** (-2 / 3), knee**3 * self._hz ** (-11 / 3)) * self._hz
        self._size = wander_arcsec(aperture_m) * np.sqrt(2 * power / power.sum())
        self._phase = random.uniform(0, 2 * math.pi, (2, _LINES))

    def __call__(self, t_s: npt.NDArray[np.float64]) -> npt.NDArray[np.float64]:
        """Two rows of arcseconds: to the right and up."""
        angle = 2 * math.pi * np.multiply.outer(t_s, self._hz)
        return np.stack([np.sin(angle + phase) @ self._size for phase in self._phase])
