"""The two cameras, optics and detectors, and where the telescope truly looks at one moment."""

import math
from dataclasses import dataclass
from typing import NamedTuple

from bus.units import ARCSEC_PER_RAD


class Look(NamedTuple):
    """One sample of the truth. Angles are observed ones, rad, hour angle positive west.

    t_ns: simulated time. roll_rad: from north to the camera's upper edge, positive through west. focus_m: of
    the focus from the middle of its travel.
    """

    t_ns: int
    hour_angle_rad: float
    declination_rad: float
    roll_rad: float = 0.0
    focus_m: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Window:
    """A part of a detector, in its pixels; 0, 0 is at the upper left."""

    left: int
    top: int
    width: int
    height: int


PHOTONS_M2_S = 8.8e9
"""Photons of a star of V = 0 above the air in the V band, per m² and s.

Source: Bessell 1979, PASP 91, 589: about 1000 per cm², s and Å. The band is 890 Å wide.
"""


@dataclass(frozen=True, kw_only=True)
class CameraModel:
    """A detector and the optics before it; SI units unless a name says otherwise.

    throughput: electrons per photon above the air. dark_e_s: dark current of a pixel at `temperature_c`.
    focusing: the focus drive moves it. blooms: full wells spill along their columns.
    """

    name: str
    sensor: str
    aperture_m: float
    focal_length_m: float
    pixel_m: float
    width: int
    height: int
    full_well_e: float
    read_noise_e: float
    dark_e_s: float
    gain_e_adu: float
    offset_adu: int
    throughput: float
    temperature_c: float
    shortest_s: float
    focusing: bool
    blooms: bool

    @property
    def pixel_rad(self) -> float:
        """Angle of a pixel in the middle of the field, rad."""
        return self.pixel_m / self.focal_length_m

    @property
    def pixel_arcsec(self) -> float:
        """The same in arcseconds."""
        return self.pixel_rad * ARCSEC_PER_RAD

    @property
    def zero_point_e_s(self) -> float:
        """Electrons per second of a star of V = 0."""
        return PHOTONS_M2_S * self.throughput * math.pi * self.aperture_m**2 / 4

    @property
    def most_adu(self) -> int:
        """The converter's end: 16 bits."""
        return (1 << 16) - 1


MAIN = CameraModel(
    name="Schmidt camera",
    sensor="KAF-16801E",  # paper, section 2.1
    aperture_m=0.5,  # paper, section 1
    focal_length_m=0.5,  # f/1 (paper, section 1)
    pixel_m=9e-6,  # paper, section 2.1
    width=4096,
    height=4096,
    # ASSUMPTION: as the same 9 µm pixel without anti-blooming in the KAF-0401E and KAF-1602E (SBIG, manual of
    # the ST-7XE to ST-10XE, table 4.3). The KAF-16801E's own data sheet was not found.
    full_well_e=100e3,
    read_noise_e=15.0,  # ASSUMPTION: a slow readout of that amplifier
    dark_e_s=0.02,  # ASSUMPTION: cooled
    gain_e_adu=1.6,  # ASSUMPTION: the full well fills the converter
    offset_adu=1000,  # ASSUMPTION
    throughput=0.35,  # ASSUMPTION: detector 0.6, optics, obstruction and air together 0.58
    temperature_c=-20.0,  # ASSUMPTION
    shortest_s=0.1,  # ASSUMPTION: a mechanical shutter
    focusing=True,
    blooms=True,  # ASSUMPTION: the letter E without L is a detector without an anti-blooming drain
)
GUIDE = CameraModel(
    name="Guide camera",
    sensor="guide",
    aperture_m=0.08,  # ASSUMPTION: a refractor beside the tube, without flexure of its own
    focal_length_m=0.4,  # ASSUMPTION
    pixel_m=3.75e-6,  # ASSUMPTION: 1.9″ to the pixel
    width=1280,  # ASSUMPTION
    height=960,  # ASSUMPTION
    full_well_e=20e3,  # ASSUMPTION
    read_noise_e=4.0,  # ASSUMPTION
    dark_e_s=0.5,  # ASSUMPTION: not cooled
    gain_e_adu=0.4,  # ASSUMPTION
    offset_adu=500,  # ASSUMPTION
    throughput=0.4,  # ASSUMPTION
    temperature_c=10.0,  # ASSUMPTION: that of the night
    shortest_s=0.01,  # ASSUMPTION: an electronic shutter
    focusing=False,
    blooms=False,  # ASSUMPTION: CMOS pixels with a drain
)
CAMERAS = (MAIN, GUIDE)
"""By Alpaca's device number."""
